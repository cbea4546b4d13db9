#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "app/commands.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include <CLI/App.hpp>
#include <fmt/core.h>

#include "osteomill/ct/write_nrrd.h"
#include "osteomill/files/input_error.h"
#include "osteomill/recording/read_recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/surface/mesh_file.h"
#include "osteomill/surface/surface_mesh.h"

namespace osteomill::app {

namespace {

// A bone as it was scanned, or as a recording left it.
struct MilledScanOptions {
  ScanOptions scan;
  std::string out;
  // Empty: as scanned.
  std::string recording;
};

CLI::App* add_command(CLI::App& program, const char* name, const char* what, MilledScanOptions& options,
                      const std::string& out_text) {
  CLI::App* command = program.add_subcommand(name, what);
  command->group("Scans");
  add_scan_source(*command, options.scan);
  command->add_option("--out", options.out, "The file to write, " + out_text)->required()->type_name("FILE");
  command
      ->add_option("--after", options.recording,
                   "A recording (HDF5) made with this scan: the bone as milled at its end")
      ->type_name("FILE");
  return command;
}

// With the isovalue given, else the recording's, else a suggested one.
LoadedBone load_milled_bone(const MilledScanOptions& options) {
  if (options.recording.empty()) return load_bone(options.scan);
  const Recording recording = read_with_what_came_before(options.recording);
  ScanOptions scan = options.scan;
  if (!scan.isovalue) scan.isovalue = recording.description.isovalue;
  scan.made_into = recording.description.scan_hash;
  LoadedBone bone = read_bone(scan);
  repeat_milling(bone.volume, recording);
  for (const std::string& warning : bone.warnings) warn(warning);
  return bone;
}

// Where no isovalue matters.
DensityGrid load_milled_densities(const MilledScanOptions& options) {
  if (!options.recording.empty()) return load_milled_bone(options).volume.grid();
  Scan scan = open_scan(options.scan);
  for (const std::string& warning : scan.warnings) warn(scan.name + ": " + warning);
  return std::move(scan.grid);
}

void run_mesh(const MilledScanOptions& options) {
  const std::string& out = options.out;
  // Before the scan is read.
  const MeshFormat format = mesh_format_of(out);
  const LoadedBone bone = load_milled_bone(options);
  const BrickMesh mesh = mesh_in_one_piece(DensityView(bone.volume));
  if (mesh.empty()) throw InputError(bone.name, "no bone is left to be meshed");
  const LabelMap* const labels = bone.volume.labels().get();
  if (labels != nullptr && !holds_colours(format))
    warn(out + ": STL holds no colours, so the labels are left out; .ply and .obj keep them");
  write_mesh(out, mesh, labels);
  fmt::print("{}\n", out);
}

void run_save(const MilledScanOptions& options) {
  if (std::filesystem::path(options.out).extension() != ".nrrd") {
    throw InputError(options.out, "a scan is saved as .nrrd");
  }
  write_nrrd(options.out, load_milled_densities(options));
  fmt::print("{}\n", options.out);
}

}  // namespace

void add_mesh_command(CLI::App& program) {
  auto options = std::make_shared<MilledScanOptions>();
  CLI::App* command =
      add_command(program, "mesh", "Write the bone's surface as one closed mesh of triangles, in mm",
                  *options, ".stl, .ply or .obj");
  add_bone_options(*command, options->scan);
  add_quiet_option(*command);
  command->callback([=] { run_mesh(*options); });
}

void add_save_command(CLI::App& program) {
  auto options = std::make_shared<MilledScanOptions>();
  CLI::App* command =
      add_command(program, "save", "Save the scan, as it was or as milled, as NRRD in the patient's frame",
                  *options, ".nrrd");
  add_quiet_option(*command);
  command->callback([=] { run_save(*options); });
}

}  // namespace osteomill::app
