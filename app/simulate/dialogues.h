#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/recording/recording.h"

namespace osteomill::app {

/// A modal question or message in the middle of the window.
struct Dialogue {
  using Action = std::function<void()>;
  struct Choice {
    std::string label;
    std::string hint;
    Action action;
  };
  std::string title;
  std::string text;
  /// Buttons: Enter presses the first, Esc the last. Empty for a message that only asks the user to wait.
  std::vector<Choice> choices;
  /// Once this returns true, the dialogue closes by itself and runs `then`.
  std::function<bool()> until;
  Action then;
  /// Lists the choices vertically, because their labels are long.
  bool is_list = false;
};

/// Dialogues, shown one at a time in the order in which they were added. For one thread.
class DialogueQueue {
 public:
  /// Ignores a dialogue whose title and text are already in the queue.
  void add(Dialogue dialogue);
  /// Reports an error until the user has closed the message.
  void add_error(const std::string& what);
  /// Runs `work` and reports an exception as an error. Returns whether there was none.
  bool run_reporting_errors(const std::function<void()>& work);

  /// Returns the dialogue to draw; null if there is none.
  const Dialogue* current() const { return dialogues_.empty() ? nullptr : &dialogues_.front(); }
  /// Notes the pressed choice, which `proceed` carries out.
  void choose(std::size_t choice) { chosen_ = choice; }
  /// Closes the current dialogue if it was answered or its condition is met, and runs the action. Call
  /// between two frames, because the action may destroy what they show.
  void proceed();

  /// Returns the errors that the user has not closed yet.
  std::vector<std::string> errors() const;

 private:
  std::deque<Dialogue> dialogues_;
  std::optional<std::size_t> chosen_;
};

/// Asks whether to save the milled bone before `what` ("Closing the window") would lose it. Once it is saved,
/// the question closes and `on_proceed` runs.
Dialogue unsaved_question(const std::string& what, std::function<bool()> is_saved, Dialogue::Action save,
                          Dialogue::Action on_proceed, Dialogue::Action stay);

/// Asks whether to write the report of the recording before the window closes.
Dialogue report_question(Dialogue::Action report, Dialogue::Action close);

/// Asks whether to measure an unfinished exercise before the window closes.
Dialogue unfinished_question(Dialogue::Action measure, Dialogue::Action close);
/// Asks the user to wait for the results of an exercise or to close the window without them.
Dialogue measuring_message(std::function<bool()> is_measured, Dialogue::Action close);

/// Asks what to do with unsaved milled bone of an earlier run that ended without asking.
Dialogue leftover_question(const SessionStart& leftover, Dialogue::Action open, Dialogue::Action remove,
                           Dialogue::Action later);

}  // namespace osteomill::app
