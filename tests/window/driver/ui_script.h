#pragma once

#include <cstddef>
#include <ctime>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "app/simulate/window_driver.h"

namespace osteomill::app {

/// Operates the window by pointer and keys from a text file with one action per line:
///     at-once                         only as the first line: starts while the first scan is still loading
///     wait SECONDS
/// settle waits until nothing is being prepared, written or moved into place
///     glide X Y SECONDS               moves the pointer to X Y
///     press NAME, release NAME        the button left, middle or right, or a key
///     wheel STEPS SECONDS             turns the wheel step by step
///     key NAME, hold NAME SECONDS     a letter or digit, space, enter, escape, shift, control, f1, f11,
///                                     backspace, page-up, page-down, arrow-up, arrow-down, arrow-left,
///                                     arrow-right
///     click LABEL                     clicks the button, box or heading with that label
///     drag LABEL PIXELS               drags the slider with that label to the right
///     type TEXT                       types into the field that was clicked
///     open PATH                       drops that file or folder onto the window
///     screenshot FILE                 writes a PNG of the window
///     say TEXT                        prints TEXT and the readings on standard output
///     state NAME                      prints the effects of all controls on standard output (state_text.h)
///     colour NAME                     prints the colour drawn at the burr on standard output (state_text.h)
///     controls FILE                   once the window has closed, appends to FILE the labels of all controls
///                                     that were drawn ("drawn LABEL") or had an effect ("worked LABEL")
///     await FILE                      waits until FILE exists, and uses the display's pointer and keys
///     display                         uses the display's pointer and keys from here on
///     resize WIDTH HEIGHT             resizes the window
///     quit                            asks to close, as the window's close button does
///     close                           closes without a question
/// Empty lines and lines that begin with # are ignored.
class UiScript : public WindowDriver {
 public:
  /// Throws InputError naming the file and the line if a line is not an action.
  explicit UiScript(const std::filesystem::path& path);

  bool is_started_before_scan() const override {
    return !actions_.empty() && actions_.front().name == "at-once";
  }
  /// Throws InputError if a label is not in the window.
  void inject_input(double passed_s, bool is_settled, Window& window) override;
  /// Takes screenshots, and prints the requested states on standard output.
  void read(const WindowContents& contents) override;
  bool has_close_request() const override { return closed_; }
  /// Writes the file of controls.
  void finish() override;

 private:
  struct Action {
    int line = 0;
    std::string name;
    std::vector<std::string> words;
    std::string text;
  };
  void begin(const Action& action, Window& window);
  void next();
  int key_of(const Action& action) const;
  void press(const Action& action, bool down);
  void say(const std::string& text, const WindowContents& contents);
  double number(const Action& action, std::size_t word) const;

  std::filesystem::path path_;
  std::filesystem::path controls_path_;
  std::vector<Action> actions_;
  std::size_t now_ = 0;
  double time_left_s_ = 0;
  bool begun_ = false;
  bool closed_ = false;
  bool is_of_display_ = false;
  // The pointer and pressed buttons, passed to ImGui in every frame.
  float x_ = 400;
  float y_ = 300;
  float to_x_ = 400;
  float to_y_ = 300;
  bool buttons_[3] = {false, false, false};
  int click_picture_ = 0;
  double wheel_left_ = 0;
  std::vector<int> keys_;
  // Keys pressed by `press` and not yet released.
  std::set<int> held_keys_;
  int pictures_since_said_ = 0;
  std::clock_t said_cpu_ = 0;
};

}  // namespace osteomill::app
