#include "app/simulate/start_page.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <ostream>
#include <system_error>

#include <imgui.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/visual/image.h"

#include "app/exercise_file.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxRecent = 8;
// Widths of an exercise's picture and text.
constexpr float kMinEntry_px = 220, kMaxEntry_px = 300;

bool is_there(const fs::path& path) {
  std::error_code unreadable;
  return fs::exists(path, unreadable);
}

std::optional<Image> read_picture(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return decode_png({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

fs::path recent_file() {
  const fs::path folder = state_folder();
  return folder.empty() ? fs::path() : folder / "recent-scans";
}

}  // namespace

fs::path exercises_folder() {
  std::error_code unreadable;
  const fs::path program = fs::read_symlink("/proc/self/exe", unreadable);
  for (fs::path folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    for (const fs::path& place : {folder / "exercises", folder / "share" / "doc" / "osteomill" / "exercises"})
      if (is_there(place / "access_cavity.toml")) return place;
  }
  return {};
}

std::vector<std::string> recent_scans() {
  std::vector<std::string> scans;
  std::ifstream in(recent_file());
  for (std::string line; std::getline(in, line) && scans.size() < kMaxRecent;)
    if (is_there(line)) scans.push_back(line);
  return scans;
}

void note_recent_scan(const std::string& scan) {
  const fs::path file = recent_file();
  std::error_code unreadable;
  const std::string path = fs::absolute(scan, unreadable).string();
  if (file.empty() || unreadable || path.find('\n') != std::string::npos) return;
  std::vector<std::string> scans = recent_scans();
  std::erase(scans, path);
  scans.insert(scans.begin(), path);
  try {
    create_folder(file.parent_path());
    write_text_atomically(file, [&](std::ostream& text) {
      for (std::size_t n = 0; n < std::min(scans.size(), kMaxRecent); ++n) text << scans[n] << '\n';
    });
  } catch (const InputError&) {
    // The scan is then not offered next time.
  }
}

StartPage::StartPage(const std::string& trainee) : recent_(recent_scans()) {
  trainee.copy(name_.data(), name_.size() - 1);
  std::vector<fs::path> files;
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(exercises_folder(), unreadable))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::ranges::sort(files);
  for (const fs::path& file : files) add_exercise(file);
}

// Ignores a faulty exercise; `--check` reports the reason.
void StartPage::add_exercise(const fs::path& file) {
  try {
    const Exercise exercise = read_exercise_file(file.string());
    Entry entry{file.string(), exercise.title, exercise.task, nullptr};
    if (const auto image = read_picture(fs::path(file).replace_extension(".png"))) {
      entry.picture = std::make_unique<PictureTexture>(*image);
      entry.width_by_height = static_cast<float>(image->width) / static_cast<float>(image->height);
    }
    entries_.push_back(std::move(entry));
  } catch (const InputError&) {
    return;
  }
}

bool StartPage::draw_entry(const Entry& entry, float width_px) const {
  ImGui::BeginGroup();
  bool is_chosen = false;
  if (entry.picture) {
    const auto texture = reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(entry.picture->name()));
    ImGui::Image(texture, {width_px, width_px / entry.width_by_height});
    is_chosen = ImGui::IsItemClicked();
  }
  is_chosen = ui::button(entry.title.c_str(), "Opens this exercise and starts recording") || is_chosen;
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width_px);
  ImGui::TextUnformatted(entry.task.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndGroup();
  return is_chosen;
}

void StartPage::draw_exercises(std::optional<StartChoice>& choice) {
  ImGui::TextUnformatted("Exercises");
  const float between_px = 2 * ImGui::GetStyle().ItemSpacing.x;
  const float columns = (ImGui::GetContentRegionAvail().x + between_px) / (ui::px(kMinEntry_px) + between_px);
  const int most = std::max(1, static_cast<int>(entries_.size()));
  if (!ImGui::BeginTable("##exercises", std::clamp(static_cast<int>(columns), 1, most))) return;
  for (const Entry& entry : entries_) {
    ImGui::TableNextColumn();
    if (draw_entry(entry, std::min(ui::px(kMaxEntry_px), ImGui::GetContentRegionAvail().x - between_px)))
      choice = StartChoice{entry.file};
  }
  ImGui::EndTable();
}

void StartPage::draw_scans(std::optional<StartChoice>& choice) {
  ImGui::TextUnformatted("Scans");
  if (const OpenKind open = draw_open_buttons(); open != OpenKind::none) choice = StartChoice{"", open};
  ImGui::SameLine();
  if (ui::button("Built-in tooth", "Opens the tooth included with the program"))
    choice = StartChoice{"builtin:tooth"};
  for (const std::string& scan : recent_)
    if (ui::button(scan.c_str(), "Opens this scan, which was opened recently")) choice = StartChoice{scan};
}

std::optional<StartChoice> StartPage::draw(const PixelSize& size) {
  std::optional<StartChoice> choice;
  ImGui::SetNextWindowPos({ui::px(8), ui::px(8)});
  ImGui::SetNextWindowSize(
      {static_cast<float>(size.width) - ui::px(16), static_cast<float>(size.height) - ui::px(16)});
  ImGui::Begin("osteomill##start", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse);
  ImGui::PushItemWidth(ui::px(220));
  ui::text_field("your name (optional)##start", "Stored in the recording of an exercise", name_.data(),
                 name_.size());
  ImGui::PopItemWidth();
  ImGui::Spacing();
  draw_exercises(choice);
  ImGui::Separator();
  draw_scans(choice);
  ImGui::End();
  return choice;
}

}  // namespace osteomill::app
