#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/ct/scan_summary.h"
#include "osteomill/ct/write_nrrd.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/visual/mesh_file.h"
#include "osteomill/visual/surface_mesh.h"

#include "app/commands.h"
#include "app/progress.h"
#include "app/scan_options.h"

namespace osteomill::app {

namespace {

struct InfoOptions {
  ScanOptions scan;
  bool json = false;
};

void run_info(const InfoOptions& options) {
  const Scan scan = open_scan(options.scan);
  const SuggestedIsovalue suggested = suggested_isovalue(options.scan, scan);
  const double isovalue = options.scan.isovalue.value_or(suggested.value);
  ScanSummary summary = summarise(scan, suggested, isovalue);
  const auto add = [&](const std::vector<std::string>& warnings) {
    summary.scan.warnings.insert(summary.scan.warnings.end(), warnings.begin(), warnings.end());
  };
  add(isovalue_warnings(scan.grid, isovalue));
  if (is_within(scan.grid, isovalue)) {
    LabelsRead labels = labels_of(options.scan, scan);
    add(labels.warnings);
    Volume bone = bone_of(scan, isovalue, options.scan.pieces).volume;
    bone.set_labels(std::move(labels.map));
    summary.labels = summarise_labels(bone);
    summary.pieces_mm3 = piece_volumes_mm3(bone);
    add(entry_warnings(bone, MillingTool{}, place_entry(bone, MillingTool{})));
  }
  fmt::print("{}", options.json ? to_json(summary) : to_text(summary));
}

// Options of the commands that write a bone to a file, as scanned or as milled at the end of a recording.
struct WriteOptions {
  ScanOptions scan;
  std::string out;
  // Empty: as scanned.
  std::string recording;
};

void add_write_options(CLI::App& command, WriteOptions& options, const std::string& out_text) {
  command.group("Scans");
  add_scan_source(command, options.scan, "the scan of --after, else the built-in tooth");
  command.add_option("--out", options.out, "File to write, " + out_text)->required()->type_name("FILE");
  command
      .add_option("--after", options.recording,
                  "Recording (HDF5) made with this scan; the bone is written as milled at its end")
      ->type_name("FILE");
}

// Uses the given isovalue, otherwise the recording's, otherwise a suggested one.
LoadedBone load_milled_bone(const WriteOptions& options) {
  if (options.recording.empty()) return load_bone(options.scan);
  const Recording recording = read_recording_chain(options.recording);
  LoadedBone bone = read_bone(scan_of(recording.description, options.scan));
  repeat_milling(bone.volume, recording);
  for (const std::string& warning : bone.warnings) warn(warning);
  return bone;
}

void run_mesh(const WriteOptions& options) {
  const std::string& out = options.out;
  // Throws for an unknown extension before the scan is read.
  const MeshFormat format = mesh_format_of(out);
  const LoadedBone bone = load_milled_bone(options);
  const BrickMesh mesh = mesh_in_one_piece(DensityView(bone.volume));
  if (mesh.empty()) throw InputError(bone.name, "no bone is left to mesh");
  const LabelMap* const labels = bone.volume.labels().get();
  if (labels != nullptr && !has_vertex_colours(format))
    warn(out + ": STL has no colours, so labels are not written; .ply and .obj keep them");
  write_mesh(out, mesh, labels);
  fmt::print("{}\n", out);
}

void run_save(const WriteOptions& options) {
  if (std::filesystem::path(options.out).extension() != ".nrrd") {
    throw InputError(options.out, "the file name must end in .nrrd");
  }
  if (options.recording.empty()) {
    // Writes the densities, so no isovalue is needed.
    const Scan scan = open_scan(options.scan);
    for (const std::string& warning : scan.warnings) warn(scan.name + ": " + warning);
    write_nrrd(options.out, scan.grid);
  } else {
    write_nrrd(options.out, load_milled_bone(options).volume.grid());
  }
  fmt::print("{}\n", options.out);
}

}  // namespace

void add_info_command(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command =
      program.add_subcommand("info", "Print a summary of a scan and the problems found in it");
  command->group("Scans");
  add_scan_options(*command, options->scan);
  command->add_flag("--json", options->json, "Print the summary as JSON");
  add_quiet_option(*command);
  command->callback([=] { run_info(*options); });
}

void add_mesh_command(CLI::App& program) {
  auto options = std::make_shared<WriteOptions>();
  CLI::App* command =
      program.add_subcommand("mesh", "Write the bone's surface as one closed triangle mesh, in mm");
  add_write_options(*command, *options, ".stl, .ply or .obj");
  add_bone_options(*command, options->scan);
  add_quiet_option(*command);
  command->callback([=] { run_mesh(*options); });
}

void add_save_command(CLI::App& program) {
  auto options = std::make_shared<WriteOptions>();
  CLI::App* command =
      program.add_subcommand("save", "Save the scan, original or milled, as NRRD in the patient's frame");
  add_write_options(*command, *options, ".nrrd");
  add_quiet_option(*command);
  command->callback([=] { run_save(*options); });
}

}  // namespace osteomill::app
