#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/recording/recording.h"

namespace osteomill::app {

/// A question or a message; all else waits meanwhile.
struct Dialogue {
  using Action = std::function<void()>;
  struct Choice {
    std::string label;
    Action action;
  };
  std::string title;
  std::string text;
  /// A button each: Enter is the first, Esc the last. None where there is only something to be waited for.
  std::vector<Choice> choices;
  /// Once this is so it goes by itself, with `then`.
  std::function<bool()> until;
  Action then;
};

/// Dialogues are shown one at a time, in the order in which they came. For one thread.
class DialogueQueue {
 public:
  /// Does nothing where one that says the same waits already.
  void add(Dialogue dialogue);
  /// What went wrong, until it was read.
  void complain(const std::string& what);

  /// The one that is to be seen; null where there is none.
  const Dialogue* shown() const { return dialogues_.empty() ? nullptr : &dialogues_.front(); }
  /// What is to be done with the one that is shown.
  void choose(std::size_t choice) { chosen_ = choice; }
  /// Does what was chosen. Between two pictures, since it may be the end of what they show.
  void proceed();

  /// Those that nobody has read.
  std::vector<std::string> complaints() const;

 private:
  std::deque<Dialogue> dialogues_;
  std::optional<std::size_t> chosen_;
};

/// Asks, before bone that was milled and not saved is lost by `what`, whether to save it. Goes by itself, and
/// on, once nothing is left to be saved.
Dialogue unsaved_question(const std::string& what, std::function<bool()> is_saved, Dialogue::Action save,
                          Dialogue::Action go_on, Dialogue::Action stay);

/// Asks whether to make the report of what was recorded before the window closes.
Dialogue report_question(Dialogue::Action report, Dialogue::Action close);

/// What is to be done with milled bone that a program left which ended without asking.
Dialogue left_milling_question(const SessionStart& left, Dialogue::Action open, Dialogue::Action remove,
                               Dialogue::Action later);

}  // namespace osteomill::app
