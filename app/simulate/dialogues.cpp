#include "app/simulate/dialogues.h"

#include <utility>

#include "app/simulate/widgets.h"
#include <fmt/core.h>
#include <imgui.h>

namespace osteomill::app {

namespace {

// True between this and ImGui::EndPopup, as long as it is shown.
bool begin_dialogue(const char* title, bool shown) {
  if (shown && !ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return false;
  if (shown) return true;
  ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return false;
}

void paragraph(const std::string& text) {
  ImGui::PushTextWrapPos(34 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
}

}  // namespace

bool dialogue_open() {
  return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

void draw_complaint(ViewState& view) {
  if (!begin_dialogue("That did not work", !view.complaint.empty())) return;
  paragraph(view.complaint);
  if (ui::choice({"Close"})) view.complaint.clear();
  ImGui::EndPopup();
}

void draw_closing(ViewState& view) {
  const bool shown = view.closing != Closing::no && view.complaint.empty();
  if (!begin_dialogue("Close osteomill", shown)) return;
  if (view.closing == Closing::asking) {
    paragraph("What you did was recorded. Shall its report be made?");
    constexpr Closing kAnswers[] = {Closing::report_asked, Closing::now, Closing::no};
    const auto chosen = ui::choice({"Make the report and close", "Close without", "Stay"});
    if (chosen) view.closing = kAnswers[*chosen];
  } else {
    paragraph("Writing the report ...");
  }
  ImGui::EndPopup();
}

std::optional<LeftAnswer> draw_left_milling(const MilledBone& milled) {
  std::optional<LeftAnswer> answer;
  if (!begin_dialogue("Milled bone that was not saved", true)) return answer;
  paragraph(
      fmt::format("When osteomill last ended, {:.1f} mm^3 had been milled of this bone and not saved:\n{}\n"
                  "(isovalue {:g}). Shall it be opened as it was?",
                  milled.removed_mm3, milled.scan.empty() ? milled.name : milled.scan, milled.isovalue));
  constexpr LeftAnswer kAnswers[] = {LeftAnswer::open, LeftAnswer::remove, LeftAnswer::later};
  if (const auto chosen = ui::choice({"Open it", "Delete it", "Later"})) answer = kAnswers[*chosen];
  if (answer) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return answer;
}

void UnsavedQuestion::ask(std::string what, Action go_on, Action stay) {
  state_ = State::asking;
  what_ = std::move(what);
  go_on_ = std::move(go_on);
  stay_ = std::move(stay);
}

void UnsavedQuestion::draw() {
  if (!begin_dialogue("Save the milled bone?", asking())) return;
  if (state_ == State::asking) {
    paragraph(what_ + " loses what was milled and not saved.");
    constexpr State kAnswers[] = {State::to_save, State::go_on, State::stay};
    if (const auto chosen = ui::choice({"Save", "Discard", "Cancel"})) state_ = kAnswers[*chosen];
  } else {
    paragraph("Saving ...");
  }
  ImGui::EndPopup();
}

void UnsavedQuestion::proceed(ViewState& view, Simulation& simulation, FilesPanel& files) {
  if (state_ == State::asking) simulation.milling.set_spindle(false);
  if (state_ == State::to_save && !files.busy()) {
    files.save_scan(view, simulation);
    state_ = State::saving;
  }
  if (state_ == State::saving) {
    files.take_result(view, simulation);
    if (files.busy()) return;
    // Whoever is to read why it is not saved stays.
    state_ = view.complaint.empty() ? State::go_on : State::stay;
  }
  if (state_ != State::go_on && state_ != State::stay) return;
  const Action action = state_ == State::go_on ? std::move(go_on_) : std::move(stay_);
  state_ = State::idle;
  if (action) action();
}

}  // namespace osteomill::app
