#include <memory>

#include "app/commands.h"
#include "app/milled_scan.h"
#include <fmt/core.h>

#include "osteomill/files/input_error.h"
#include "osteomill/surface/mesh_file.h"
#include "osteomill/surface/surface_mesh.h"

namespace osteomill::app {

namespace {

void run_mesh(const MilledScanOptions& options) {
  mesh_format_of(options.out());  // before the scan is read
  const LoadedBone bone = load_milled_bone(options);
  const BrickMesh mesh = mesh_in_one_piece(DensityView(bone.volume));
  if (mesh.empty()) throw InputError(bone.name, "no bone is left to be meshed");
  write_mesh(options.out(), mesh);
  fmt::print("{}\n", options.out());
}

}  // namespace

void add_mesh_command(CLI::App& program) {
  auto options = std::make_shared<MilledScanOptions>();
  CLI::App* command =
      program.add_subcommand("mesh", "Write the bone's surface as one closed mesh of triangles, in mm");
  add_milled_scan_options(*command, *options, ".stl, .ply or .obj");
  command->callback([=] { run_mesh(*options); });
}

}  // namespace osteomill::app
