#pragma once

#include <cstddef>
#include <ctime>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "app/simulate/window_driver.h"

namespace osteomill::app {

/// Works the window as a person would, by pointer and keys, from a text file with a line for each action:
///     at-once                         as the first line: begins while the first scan is still being opened
///     wait SECONDS
///     settle                          until nothing is being prepared, written or brought to its place
///     glide X Y SECONDS               moves the pointer there
///     press NAME, release NAME        the button left, middle or right, or a key
///     wheel STEPS SECONDS             turns it step by step
///     key NAME, hold NAME SECONDS     a letter, or space, enter, escape, shift, control, f1, f11, backspace,
///     page-up,
///                                     page-down, arrow-up, arrow-down, arrow-left, arrow-right
///     click LABEL                     the button, box or heading of that label
///     drag LABEL PIXELS               the slider of that label, to the right
///     type TEXT                       into the field that was clicked
///     open PATH                       drops that file or folder onto the window
///     screenshot FILE                 a PNG of the window
///     say TEXT                        on standard output, with the readings
///     state NAME                      on standard output, all that the controls bring about (state_text.h)
///     colour NAME                     on standard output, the colour that is seen at the burr (state_text.h)
///     controls FILE                   once the window has closed, adds to it the labels of all controls that
///                                     were drawn ("drawn LABEL") and of those that acted ("worked LABEL")
///     await FILE                      until it is there; meanwhile pointer and keys are the display's own
///     display                         from here on pointer and keys are the display's own
///     resize WIDTH HEIGHT             the window
///     quit                            asks to close, as the window's own button does
///     close                           closes without a question
/// Empty lines and lines that begin with # mean nothing.
class UiScript : public WindowDriver {
 public:
  /// Throws InputError naming the file and the line for what is not an action.
  explicit UiScript(const std::filesystem::path& path);

  bool starts_before_scan() const override { return !actions_.empty() && actions_.front().name == "at-once"; }
  /// Throws InputError if a label is not in the window.
  void give_input(double passed_s, bool is_settled, Window& window) override;
  /// Takes screenshots, and prints what the script asks for on standard output.
  void read(const WindowContents& contents) override;
  bool wants_to_close() const override { return closed_; }
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
  // The pointer and what is pressed, as ImGui is told at every picture.
  float x_ = 400;
  float y_ = 300;
  float to_x_ = 400;
  float to_y_ = 300;
  bool buttons_[3] = {false, false, false};
  int click_picture_ = 0;
  double wheel_left_ = 0;
  std::vector<int> keys_;
  // Pressed by `press` and not yet released.
  std::set<int> held_keys_;
  int pictures_since_said_ = 0;
  std::clock_t said_cpu_ = 0;
};

}  // namespace osteomill::app
