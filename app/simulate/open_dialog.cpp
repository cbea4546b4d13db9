#include "app/simulate/open_dialog.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "app/simulate/panels.h"
#include "app/simulate/start_page.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* kFolderHint = "A folder; double-click or press Enter to show it";
constexpr const char* kFileHint = "A scan or a recording; double-click or press Enter to open it";

fs::path home() {
  const char* const folder = std::getenv("HOME");
  return folder != nullptr && *folder != 0 ? fs::path(folder) : fs::path("/");
}

// Returns the folder of the most recent scan, which often holds the next one.
fs::path first_folder(const std::vector<std::string>& recent) {
  std::error_code unreadable;
  return recent.empty() ? fs::current_path(unreadable) : fs::path(recent.front()).parent_path();
}

}  // namespace

OpenKind draw_open_buttons() {
  OpenKind request = OpenKind::none;
  if (ui::button("Open",
                 "Opens a scan (DICOM, NRRD, MetaImage, NIfTI, or a zip of one), a recording, or an exercise "
                 "(Ctrl+O)"))
    request = OpenKind::file;
  ImGui::SameLine();
  if (ui::button("Open a folder", "Opens a folder of DICOM slices, including its subfolders"))
    request = OpenKind::folder;
  const ImGuiIO& io = ImGui::GetIO();
  const bool by_key = io.KeyCtrl && !io.WantTextInput && ui::is_key_pressed(GLFW_KEY_O);
  return by_key ? OpenKind::file : request;
}

void OpenDialog::begin(OpenKind request, const std::string& last_folder) {
  recent_ = recent_scans();
  std::erase_if(recent_, [](const std::string& scan) { return scan.starts_with("builtin:"); });
  if (folder_.empty()) folder_ = last_folder.empty() ? first_folder(recent_) : fs::path(last_folder);
  portal_.ask(request == OpenKind::folder, folder_);
}

void OpenDialog::show() {
  is_shown_ = true;
  go_to(folder_);
}

void OpenDialog::go_to(const fs::path& folder) {
  folder_ = folder.lexically_normal();
  if (!folder_.has_filename() && folder_.has_relative_path()) folder_ = folder_.parent_path();
  listing_ = {};
  selected_ = -1;
  const std::string text = folder_.string();
  path_.fill(0);
  text.copy(path_.data(), path_.size() - 1);
  reader_.begin(folder_);
}

void OpenDialog::enter(const FolderListing::Entry& entry) {
  if (entry.is_folder) return go_to(folder_ / entry.name);
  chosen_ = (folder_ / entry.name).string();
}

// Only the listing thread can find out whether a typed path is a file: checking may block.
void OpenDialog::take_listing() {
  std::optional<FolderListing> listing = reader_.take();
  if (!listing) return;
  listing_ = *std::move(listing);
  if (!listing_.is_file) return;
  chosen_ = folder_.string();
  folder_ = folder_.parent_path();
}

void OpenDialog::take_keys() {
  if (ImGui::IsWindowAppearing() || ImGui::GetIO().WantTextInput) return;
  const auto count = static_cast<int>(listing_.entries.size());
  const int step = ImGui::IsKeyPressed(GLFW_KEY_DOWN) ? 1 : ImGui::IsKeyPressed(GLFW_KEY_UP) ? -1 : 0;
  if (step != 0 && count > 0) {
    selected_ = std::clamp(selected_ + step, 0, count - 1);
    is_scrolled_to_ = false;
  }
  if (ui::is_key_pressed(GLFW_KEY_BACKSPACE)) return go_to(folder_.parent_path());
  if (ui::is_key_pressed(GLFW_KEY_ENTER) && selected_ >= 0)
    enter(listing_.entries[static_cast<std::size_t>(selected_)]);
}

void OpenDialog::draw_places() {
  if (ui::row("Home", "Shows your home folder", false)) go_to(home());
  if (!recent_.empty()) ImGui::TextDisabled("Recent");
  for (const std::string& scan : recent_) {
    if (ui::row(fs::path(scan).filename().string().append("##").append(scan).c_str(), "Opens " + scan, false))
      chosen_ = scan;
  }
}

void OpenDialog::draw_files() {
  take_listing();
  if (reader_.is_reading()) ImGui::TextDisabled("Reading the folder ...");
  if (!listing_.complaint.empty()) ui::warning(listing_.complaint);
  if (!reader_.is_reading() && listing_.complaint.empty() && listing_.entries.empty())
    ImGui::TextDisabled("No folders, and no files that can be opened");
  std::optional<FolderListing::Entry> entered;
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(listing_.entries.size()));
  if (selected_ >= 0 && !std::exchange(is_scrolled_to_, true))
    ImGui::SetScrollY(
        std::max(0.0f, (static_cast<float>(selected_) - 4) * ImGui::GetTextLineHeightWithSpacing()));
  while (clipper.Step()) {
    for (int n = clipper.DisplayStart; n < clipper.DisplayEnd; ++n) {
      const FolderListing::Entry& entry = listing_.entries[static_cast<std::size_t>(n)];
      const std::string label = entry.is_folder ? entry.name + "/" : entry.name;
      if (ui::row(label.c_str(), entry.is_folder ? kFolderHint : kFileHint, n == selected_)) {
        selected_ = n;
        if (ImGui::IsMouseDoubleClicked(0)) entered = entry;
      }
    }
  }
  if (listing_.has_more) ImGui::TextDisabled("More entries: type a path above");
  if (entered) enter(*entered);
}

std::optional<std::string> OpenDialog::draw(OpenKind request, bool is_waiting, std::string& last_folder) {
  if (request != OpenKind::none && !is_waiting && !is_shown_) {
    if (portal_.is_asking()) {
      // The dialog is hidden, or has ended without an answer.
      portal_.give_up();
      show();
    } else {
      begin(request, last_folder);
    }
  }
  if (const auto answer = portal_.take_answer()) {
    if (!answer->is_available) show();
    if (answer->path) last_folder = (folder_ = fs::path(*answer->path).parent_path()).string();
    if (answer->path) return answer->path;
  }
  if (!is_shown_ || is_waiting) return std::nullopt;
  if (!ImGui::IsPopupOpen(kOpenPopup)) ImGui::OpenPopup(kOpenPopup);
  const ImVec2 room = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * room.x, 0.5f * room.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(
      {std::min(ui::px(760), room.x - ui::px(16)), std::min(ui::px(480), room.y - ui::px(16))});
  if (!ImGui::BeginPopupModal(kOpenPopup, nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove))
    return std::nullopt;
  take_keys();
  bool is_cancelled = !ImGui::IsWindowAppearing() && ui::is_key_pressed(GLFW_KEY_ESCAPE);
  if (ui::button("Up", "Shows the parent folder (Backspace)")) go_to(folder_.parent_path());
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-ui::px(44));
  if (ui::text_field("path", "Path of a file or folder; press Enter to open it", path_.data(), path_.size(),
                     ImGuiInputTextFlags_AutoSelectAll) &&
      path_[0] != 0)
    go_to(folder_ / path_.data());
  const float below_px = ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild("places", {ui::px(190), -below_px}, true);
  draw_places();
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("files", {0, -below_px}, true);
  draw_files();
  ImGui::EndChild();
  const bool is_selected = selected_ >= 0 && static_cast<std::size_t>(selected_) < listing_.entries.size();
  if (ui::button("Open selected", "Opens the selected file, or shows the selected folder", is_selected))
    enter(listing_.entries[static_cast<std::size_t>(selected_)]);
  ImGui::SameLine();
  if (ui::button("Open this folder",
                 "Opens the DICOM slices, or the only scan, in this folder and its subfolders"))
    chosen_ = folder_.string();
  ImGui::SameLine();
  is_cancelled = ui::button("Cancel", "Opens nothing") || is_cancelled;
  if (is_cancelled || chosen_) {
    is_shown_ = false;
    if (chosen_) last_folder = folder_.string();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  return std::exchange(chosen_, std::nullopt);
}

Dialogue series_question(const std::string& scan, const std::vector<SeriesSummary>& series,
                         const std::function<void(const std::string& number)>& open,
                         Dialogue::Action cancel) {
  Dialogue question{"Series",
                    fmt::format("{} holds {} series. Which one do you want to open?", scan, series.size()),
                    {},
                    {},
                    {}};
  question.is_list = true;
  for (const SeriesSummary& one : series) {
    std::string label = fmt::format("{}: {} \"{}\", ", one.number, one.modality, one.description);
    if (!one.distinguishing_marks.empty()) label += one.distinguishing_marks + ", ";
    label += fmt::format("{} slices of {} x {}", one.slices, one.columns, one.rows);
    label += one.thickness_mm ? fmt::format(", {:.4g} mm thick", *one.thickness_mm) : ", not a volume";
    question.choices.push_back(
        {label, "Opens only this series", [open, number = one.number] { open(number); }});
  }
  question.choices.push_back({"Cancel", "Opens none of them", std::move(cancel)});
  return question;
}

}  // namespace osteomill::app
