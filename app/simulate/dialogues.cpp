#include "app/simulate/dialogues.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/core.h>

namespace osteomill::app {

namespace {

constexpr const char* kErrorTitle = "Error";

}  // namespace

void DialogueQueue::add(Dialogue dialogue) {
  const auto same = [&](const Dialogue& other) {
    return other.title == dialogue.title && other.text == dialogue.text;
  };
  if (std::none_of(dialogues_.begin(), dialogues_.end(), same)) dialogues_.push_back(std::move(dialogue));
}

void DialogueQueue::add_error(const std::string& what) {
  add({kErrorTitle, what, {{"Close", "Closes this message", {}}}, {}, {}});
}

bool DialogueQueue::run_reporting_errors(const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const std::exception& error) {
    add_error(error.what());
    return false;
  }
}

void DialogueQueue::proceed() {
  if (dialogues_.empty()) return;
  Dialogue& front = dialogues_.front();
  if (!chosen_ && !(front.until && front.until())) return;
  const Dialogue::Action action =
      std::move(chosen_ ? front.choices.at(*std::exchange(chosen_, std::nullopt)).action : front.then);
  dialogues_.pop_front();
  if (action) action();
}

std::vector<std::string> DialogueQueue::errors() const {
  std::vector<std::string> complaints;
  for (const Dialogue& dialogue : dialogues_) {
    if (dialogue.title == kErrorTitle) complaints.push_back(dialogue.text);
  }
  return complaints;
}

Dialogue unsaved_question(const std::string& what, std::function<bool()> is_saved, Dialogue::Action save,
                          Dialogue::Action on_proceed, Dialogue::Action stay) {
  return {"Save the milled bone?",
          what + " discards unsaved milling.",
          {{"Save", "Saves the milled bone as a scan and continues", std::move(save)},
           {"Discard", "Continues without saving", on_proceed},
           {"Cancel", "Changes nothing", std::move(stay)}},
          std::move(is_saved),
          on_proceed};
}

Dialogue report_question(Dialogue::Action report, Dialogue::Action close) {
  return {"Close osteomill",
          "You made a recording. Write its report before closing the window?",
          {{"Make the report and close", "Writes a report of the recording, then closes the window",
            std::move(report)},
           {"Close without", "Closes the window; the recording is kept", std::move(close)},
           {"Stay", "Keeps the window open", {}}},
          {},
          {}};
}

Dialogue unfinished_question(Dialogue::Action measure, Dialogue::Action close) {
  return {"Close osteomill",
          "The exercise is not finished. Measure it before closing the window?",
          {{"Measure and close", "Writes the results so far, then closes the window", std::move(measure)},
           {"Close without", "Closes the window; the recording is kept", std::move(close)},
           {"Stay", "Keeps the window open", {}}},
          {},
          {}};
}

Dialogue measuring_message(std::function<bool()> is_measured, Dialogue::Action close) {
  return {"Close osteomill",
          "The exercise is being measured.",
          {{"Close without results", "Closes the window at once; the recording is kept", close},
           {"Stay", "Keeps the window open", {}}},
          std::move(is_measured),
          close};
}

Dialogue leftover_question(const SessionStart& leftover, Dialogue::Action open, Dialogue::Action remove,
                           Dialogue::Action later) {
  // Removed pieces do not count as milled.
  const std::string what = leftover.removed_mm3 > 0
                               ? fmt::format("{:.1f} mm³ of milled bone", leftover.removed_mm3)
                               : "removed pieces of bone";
  return {"Unsaved milling",
          fmt::format("When osteomill last ended, {} had not been saved:\n{}\n"
                      "(isovalue {:g}). Open it again?",
                      what, leftover.run.scan_name, leftover.run.isovalue),
          {{"Open it", "Opens the scan as it had been milled", std::move(open)},
           {"Delete it", "Deletes the unsaved milling but not the scan", std::move(remove)},
           {"Later", "Asks again at the next start", std::move(later)}},
          {},
          {}};
}

}  // namespace osteomill::app
