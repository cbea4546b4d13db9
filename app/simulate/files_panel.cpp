#include "app/simulate/files_panel.h"

#include <ctime>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <imgui.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/ct/write_nrrd.h"
#include "osteomill/recording/recording.h"
#include "osteomill/study/write_report.h"
#include "osteomill/visual/mesh_file.h"
#include "osteomill/visual/surface_mesh.h"

#include "app/scan_options.h"
#include "app/simulate/theme.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

// Opens a file with the desktop's default program.
void open_outside(const fs::path& path) {
  std::string program = "xdg-open";
  std::string argument = fs::absolute(path).string();
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) {
    throw InputError(argument, "cannot be opened: xdg-open is not installed");
  }
  std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
}

}  // namespace

fs::path FilesPanel::name(const std::string& what) const {
  const std::string time = fmt::format("{:%Y%m%d-%H%M%S}-{}", fmt::localtime(std::time(nullptr)), ::getpid());
  const std::size_t dot = what.rfind('.');
  fs::path path = folder_ / fmt::format("{}-{}", time, what);
  for (int n = 2; fs::exists(path); ++n) {
    path = folder_ / fmt::format("{}-{}-{}{}", time, what.substr(0, dot), n,
                                 dot == std::string::npos ? "" : what.substr(dot));
  }
  return path;
}

void FilesPanel::record(ViewState& view, Simulation& simulation, const std::string& what) {
  view.dialogues.run_reporting_errors([&] {
    create_folder(folder_);
    if (simulation.milling.is_recording()) {
      last_recording_ = simulation.milling.stop_recording();
      view.message = "Recorded " + last_recording_.string();
      view.result = last_recording_;
    } else {
      const bool is_beginning = simulation.milling.timing().ticks == 0;
      recorded_before_s_ = is_beginning && simulation.from ? simulation.from->time_s : 0;
      view.message = simulation.milling.start_recording(
          name(what), simulation.describe(),
          [this, camera = view.camera,
           begins = is_beginning](std::string_view name) -> std::optional<std::vector<unsigned char>> {
            // Nothing has been drawn before the first tick.
            if (name == kPictureAlong || (begins && name == kPictureBefore)) return std::nullopt;
            return encode_png(take_picture_(camera));
          });
      recording_since_ = std::chrono::steady_clock::now();
    }
  });
}

void FilesPanel::begin_recording(ViewState& view, Simulation& simulation, const std::string& what) {
  if (!simulation.milling.is_recording()) record(view, simulation, what);
}

void FilesPanel::end_recording(ViewState& view, Simulation& simulation) {
  if (simulation.milling.is_recording()) record(view, simulation);
}

void FilesPanel::close(ViewState& view, Simulation& simulation) {
  end_recording(view, simulation);
  if (work_.valid()) work_.wait();
}

template <typename Write>
void FilesPanel::begin(const fs::path& path, Write write) {
  is_written_ = false;
  create_folder(folder_);
  work_ = std::async(std::launch::async, [path, write = std::move(write)] {
    write(path);
    return WriteResult{"Saved " + path.string(), path, {}};
  });
}

void FilesPanel::make_report() {
  is_written_ = false;
  work_ = std::async(std::launch::async, [recording = last_recording_, folder = name("report")] {
    const fs::path page = write_report(split_by_setup(read_recording(recording)), folder, recorded_scan);
    return WriteResult{"Report in " + page.string(), page, recording};
  });
}

void FilesPanel::end_with_report(ViewState& view, Simulation& simulation) {
  end_recording(view, simulation);
  if (!last_recording_.empty()) make_report();
}

void FilesPanel::save_scan(ViewState& view, Simulation& simulation) {
  view.dialogues.run_reporting_errors([&] {
    DensityGrid grid;
    std::uint64_t version = 0;
    simulation.milling.follower().read([&](const Volume& bone) {
      grid = bone.grid();
      version = simulation.milling.follower().version();
    });
    begin(name("milled.nrrd"), [grid = std::move(grid)](const fs::path& path) { write_nrrd(path, grid); });
    saving_version_ = version;
  });
}

void FilesPanel::save_picture(ViewState& view, const Image& picture) const {
  view.dialogues.run_reporting_errors([&] {
    create_folder(folder_);
    const fs::path path = name("picture.png");
    write_png(path, picture);
    view.message = "Saved " + path.string();
    view.result = path;
  });
}

void FilesPanel::save_text(ViewState& view, const std::string& what, const std::string& text) const {
  view.dialogues.run_reporting_errors([&] {
    create_folder(folder_);
    const fs::path path = name(what);
    write_text_atomically(path, [&](std::ostream& out) { out << text; });
    view.message = "Saved " + path.string();
    view.result = path;
  });
}

void FilesPanel::take_result(ViewState& view, Simulation& simulation) {
  if (!work_.valid() || work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const auto version = std::exchange(saving_version_, std::nullopt);
  view.dialogues.run_reporting_errors([&] {
    WriteResult done = work_.get();
    view.message = std::move(done.message);
    view.result = std::move(done.result);
    is_written_ = true;
    if (!done.recording.empty()) {
      view.report = view.result;
      reported_ = done.recording;
    }
    if (version) simulation.autosave.mark_saved(*version);
  });
}

std::optional<double> FilesPanel::recording_s(const Simulation& simulation) const {
  if (!simulation.milling.is_recording()) return std::nullopt;
  return recorded_before_s_ +
         std::chrono::duration<double>(std::chrono::steady_clock::now() - recording_since_).count();
}

float FilesPanel::draw_message(ViewState& view, const Simulation& simulation, const PixelSize& size) {
  const bool preparing = simulation.milling.is_preparing();
  const float bottom_px = static_cast<float>(size.height) - ui::px(8);
  if (view.message.empty() && !is_busy() && !preparing) return bottom_px;
  ImGui::SetNextWindowPos({static_cast<float>(size.width) - ui::px(ui::kSidePanelWidth_px + 8), bottom_px},
                          ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSize({ui::px(ui::kSidePanelWidth_px), 0});
  ImGui::Begin("##said", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  const ImVec4 going_on = ui::ink(ui::Ink::note);
  if (preparing) ImGui::TextColored(going_on, "Preparing ...");
  if (is_busy()) ImGui::TextColored(going_on, "Writing ...");
  if (!view.message.empty()) {
    ImGui::TextWrapped("%s", view.message.c_str());
    if (!view.report.empty()) {
      if (ui::button("Open report", "Shows the report in the browser"))
        view.dialogues.run_reporting_errors([&] { open_outside(view.report); });
      ImGui::SameLine();
    }
    if (!view.result.empty()) {
      if (ui::button("Open folder", "Shows the folder of the saved file"))
        view.dialogues.run_reporting_errors([&] { open_outside(fs::absolute(view.result).parent_path()); });
      ImGui::SameLine();
    }
    if (ui::button("Hide", "Hides this message; the file is kept")) {
      view.message.clear();
      view.result.clear();
      view.report.clear();
    }
  }
  const float top_px = ImGui::GetWindowPos().y - ui::px(8);
  ImGui::End();
  return top_px;
}

void FilesPanel::draw(ViewState& view, Simulation& simulation) {
  // After a write failure (e.g. a full disk) the ticks recorded so far stay in the unfinished file.
  if (simulation.milling.has_recording_failed()) {
    view.dialogues.run_reporting_errors([&] { simulation.milling.stop_recording(); });
    view.message.clear();
  }
  if (!ui::header("Record and save", "Record the session, and save bone and pictures", view.open.files))
    return;
  if (ui::button(simulation.milling.is_recording() ? "Stop recording##r" : "Record##r",
                 "Starts or stops recording your motions and the forces")) {
    // Stopping the recording of an exercise shows its results.
    if (simulation.exercise && simulation.milling.is_recording())
      view.finish_requested = true;
    else
      record(view, simulation);
  }
  ImGui::SameLine();
  const bool free = !is_busy();
  if (ui::button("Report", "Writes a report with charts and tables of the last recording",
                 free && !last_recording_.empty()))
    make_report();
  ImGui::SameLine();
  if (ui::button("Play back", "Plays the last recording back; you can continue milling from any moment",
                 free && !last_recording_.empty()))
    view.scan_requested = last_recording_.string();
  if (ui::button("Save scan", "Saves the milled bone as a scan (NRRD)", free)) save_scan(view, simulation);
  ImGui::SameLine();
  if (ui::button("Save surface",
                 "Saves the surface of the milled bone as triangles (PLY), e.g. for 3D printing", free)) {
    view.dialogues.run_reporting_errors([&] {
      BrickMesh mesh;
      simulation.milling.follower().read(
          [&](const Volume& bone) { mesh = mesh_in_one_piece(DensityView(bone)); });
      begin(name("surface.ply"), [mesh = std::move(mesh), labels = simulation.scan.labels](
                                     const fs::path& path) { write_mesh(path, mesh, labels.get()); });
    });
  }
  ImGui::SameLine();
  if (ui::button("Save picture", "Saves the view of the bone, without panels, as a picture (PNG)"))
    view.picture_requested = true;
}

}  // namespace osteomill::app
