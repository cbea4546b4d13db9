#include <memory>
#include <string>

#include "app/commands.h"
#include "app/milled_scan.h"
#include "app/positive_number.h"
#include "app/progress.h"
#include <fmt/core.h>

#include "osteomill/files/input_error.h"
#include "osteomill/surface/mesh_file.h"
#include "osteomill/surface/surface_mesh.h"

namespace osteomill::app {

namespace {

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

}  // namespace

void add_mesh_command(CLI::App& program) {
  auto options = std::make_shared<MilledScanOptions>();
  CLI::App* command =
      program.add_subcommand("mesh", "Write the bone's surface as one closed mesh of triangles, in mm");
  command->group("Scans");
  add_milled_scan_options(*command, *options, ".stl, .ply or .obj");
  command->add_option("--iso", options->scan.isovalue, "Isovalue: bone where the density is greater")
      ->check(not_empty())
      ->type_name("DENSITY");
  add_label_options(*command, options->scan.labels);
  add_quiet_option(*command);
  command->callback([=] { run_mesh(*options); });
}

}  // namespace osteomill::app
