#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "app/simulate/window.h"

namespace osteomill::app {

/// Works the window as a person would, by pointer and keys, from a text file with a line for each action, so
/// that the whole window can be tested:
///     at-once                         as the first line: begins while the first scan is still being opened
///     wait SECONDS
///     settle                          until nothing is being prepared, written or brought to its place
///     glide X Y SECONDS               moves the pointer there
///     press NAME, release NAME        the button left, middle or right, or a key
///     wheel STEPS SECONDS             turns it step by step
///     key NAME, hold NAME SECONDS     a letter, or space, enter, escape, shift, control, f1, f11, page-up,
///                                     page-down, arrow-up, arrow-down, arrow-left, arrow-right
///     click LABEL                     the button, box or heading of that label
///     drag LABEL PIXELS               the slider of that label, to the right
///     type TEXT                       into the field that was clicked
///     open PATH                       drops that file or folder onto the window
///     screenshot FILE                 a PNG of the window
///     say TEXT                        on standard output, with the readings
///     state NAME                      on standard output, all that the controls bring about (panels.h)
///     controls FILE                   once the window has closed, adds to it the labels of all controls that
///                                     were drawn ("drawn LABEL") and of those that acted ("worked LABEL")
///     await FILE                      until it is there; meanwhile pointer and keys are the display's own
///     resize WIDTH HEIGHT             the window
///     quit                            asks to close, as the window's own button does
///     close                           closes without a question
/// Empty lines and lines that begin with # mean nothing.
class UiScript {
 public:
  /// Throws InputError naming the file and the line for what is not an action.
  explicit UiScript(const std::filesystem::path& path);

  /// To be called before ImGui's frame begins: hands it the events of this picture, `passed_s` after the last
  /// one. Throws InputError where a label is not in the window.
  void feed(double passed_s, bool settled, Window& window);
  /// To be called after the window was drawn: takes screenshots. Returns what is to be printed, if anything,
  /// and whether that is all of the state under this name.
  struct Saying {
    std::string text;
    bool state = false;
  };
  Saying after_drawing(const Window& window);
  /// To be called after the last picture: writes the file of controls.
  void end() const;
  /// Whether it begins before there is a scan.
  bool at_once() const { return !actions_.empty() && actions_.front().name == "at-once"; }
  /// Whether the window is to close without a question.
  bool closed() const { return closed_; }

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
  double number(const Action& action, std::size_t word) const;

  std::filesystem::path path_;
  std::filesystem::path controls_path_;
  std::vector<Action> actions_;
  std::size_t now_ = 0;
  double time_left_s_ = 0;
  bool begun_ = false;
  bool closed_ = false;
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
};

}  // namespace osteomill::app
