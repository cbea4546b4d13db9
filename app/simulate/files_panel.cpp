#include "app/simulate/files_panel.h"

#include <chrono>
#include <ctime>
#include <functional>

#include "app/simulate/widgets.h"
#include <fmt/chrono.h>
#include <fmt/core.h>
#include <imgui.h>
#include <unistd.h>

#include "osteomill/ct/write_nrrd.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/recording/read_recording.h"
#include "osteomill/report/write_report.h"
#include "osteomill/surface/mesh_file.h"
#include "osteomill/surface/surface_mesh.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

// Throws nothing that a dialogue could not tell.
void attempt(ViewState& view, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    view.complaint = error.what();
  }
}

std::string save_scan(const fs::path& path, const DensityGrid& grid) {
  write_nrrd(path, grid);
  return "Saved " + path.string();
}

std::string save_surface(const fs::path& path, const BrickMesh& mesh) {
  write_mesh(path, mesh);
  return "Saved " + path.string();
}

std::string report_on(const fs::path& recording, const fs::path& folder) {
  return "Report in " + write_report({read_recording(recording)}, folder).string();
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

void FilesPanel::record(ViewState& view, Simulation& simulation) {
  attempt(view, [&] {
    create_folder(folder_);
    if (simulation.milling.recording()) {
      last_recording_ = simulation.milling.stop_recording();
      view.message = "Recorded " + last_recording_.string();
    } else {
      simulation.milling.start_recording(
          name("recording.h5"), simulation.milling.describe(simulation.scan_name, simulation.command_line));
      view.message.clear();
    }
  });
}

void FilesPanel::end_recording(ViewState& view, Simulation& simulation) {
  if (const auto ended = simulation.milling.take_ended_recording()) last_recording_ = *ended;
  if (!simulation.milling.recording()) return;
  record(view, simulation);
  view.message = "The change ended the recording " + last_recording_.string();
}

void FilesPanel::close(ViewState& view, Simulation& simulation) {
  if (simulation.milling.recording()) record(view, simulation);
  if (work_.valid()) work_.wait();
}

void FilesPanel::make_report() {
  work_ = std::async(std::launch::async, report_on, last_recording_, name("report"));
}

void FilesPanel::end_with_report(ViewState& view, Simulation& simulation) {
  if (simulation.milling.recording()) record(view, simulation);
  if (!last_recording_.empty()) make_report();
}

void FilesPanel::take_result(ViewState& view) {
  if (!work_.valid() || work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  attempt(view, [&] { view.message = work_.get(); });
}

void FilesPanel::draw(ViewState& view, Simulation& simulation) {
  take_result(view);
  if (const auto ended = simulation.milling.take_ended_recording()) {
    last_recording_ = *ended;
    view.message = "The change ended the recording " + ended->string();
  }
  if (!ui::header("Record and save", true)) return;
  if (ui::button(simulation.milling.recording() ? "Stop recording##r" : "Record##r"))
    record(view, simulation);
  ImGui::SameLine();
  const bool free = !busy();
  if (ui::button("Report", free && !last_recording_.empty())) make_report();
  ui::hint("Figures and tables of the last recording");
  const auto save = [&](std::future<std::string> work) { work_ = std::move(work); };
  if (ui::button("Save scan", free)) {
    attempt(view, [&] {
      create_folder(folder_);
      DensityGrid grid;
      simulation.milling.read_bone([&](const Volume& bone) { grid = bone.grid(); });
      save(std::async(std::launch::async, save_scan, name("milled.nrrd"), std::move(grid)));
    });
  }
  ImGui::SameLine();
  if (ui::button("Save surface", free)) {
    attempt(view, [&] {
      create_folder(folder_);
      BrickMesh mesh;
      simulation.milling.read_bone([&](const Volume& bone) { mesh = mesh_in_one_piece(DensityView(bone)); });
      save(std::async(std::launch::async, save_surface, name("surface.ply"), std::move(mesh)));
    });
  }
  ImGui::SameLine();
  if (ui::button("Save picture")) view.picture_asked = true;
  if (busy()) {
    ImGui::TextColored({0.55f, 0.80f, 1.0f, 1}, "writing ...");
  }
}

}  // namespace osteomill::app
