#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/recording/recording.h"

namespace osteomill::app {

/// A question or a message in the middle of the window. Input goes nowhere else while it is shown.
struct Dialogue {
  using Action = std::function<void()>;
  struct Choice {
    std::string label;
    std::string hint;
    Action action;
  };
  std::string title;
  std::string text;
  /// A button for each: Enter presses the first, Esc the last. Empty for a message that only asks to wait.
  std::vector<Choice> choices;
  /// Once this is true the dialogue closes by itself and does `then`.
  std::function<bool()> until;
  Action then;
  /// The choices stand below each other, because their labels are long.
  bool is_list = false;
};

/// Dialogues, shown one at a time in the order in which they were added. For one thread.
class DialogueQueue {
 public:
  /// Does nothing if one with the same title and text is there already.
  void add(Dialogue dialogue);
  /// Says what went wrong, until somebody has read it.
  void add_error(const std::string& what);
  /// Does the work and complains of what it throws. Returns whether it threw nothing.
  bool run_reporting_errors(const std::function<void()>& work);

  /// The dialogue to be drawn; null if there is none.
  const Dialogue* current() const { return dialogues_.empty() ? nullptr : &dialogues_.front(); }
  /// Notes which of its choices was pressed; `proceed` does it.
  void choose(std::size_t choice) { chosen_ = choice; }
  /// Closes the dialogue shown, if it was answered or need not wait any longer, and does what that means. To
  /// be called between two pictures, since it may destroy what they show.
  void proceed();

  /// The complaints that the user has not read yet.
  std::vector<std::string> errors() const;

 private:
  std::deque<Dialogue> dialogues_;
  std::optional<std::size_t> chosen_;
};

/// Asks whether to save the milled bone before `what` ("Closing the window") would lose it. Once it is saved
/// the question closes by itself and `on_proceed` is done.
Dialogue unsaved_question(const std::string& what, std::function<bool()> is_saved, Dialogue::Action save,
                          Dialogue::Action on_proceed, Dialogue::Action stay);

/// Asks whether to make the report of what was recorded before the window closes.
Dialogue report_question(Dialogue::Action report, Dialogue::Action close);

/// Asks whether to measure an exercise that is not finished before the window closes.
Dialogue unfinished_question(Dialogue::Action measure, Dialogue::Action close);
/// Asks to wait until an exercise has been measured, or to close the window without results.
Dialogue measuring_message(std::function<bool()> is_measured, Dialogue::Action close);

/// Asks what to do with unsaved milled bone of an earlier run of the program that ended without asking.
Dialogue leftover_question(const SessionStart& leftover, Dialogue::Action open, Dialogue::Action remove,
                           Dialogue::Action later);

}  // namespace osteomill::app
