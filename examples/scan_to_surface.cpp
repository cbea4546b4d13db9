// From a scan to a surface: reads a scan of any format, or the built-in tooth, suggests an isovalue, and
// writes the bone's surface and a picture of it.
//
//     ./scan_to_surface [SCAN]

#include <cstdio>
#include <exception>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <osteomill/ct/read_scan.h>
#include <osteomill/visual/bone_picture.h>
#include <osteomill/visual/camera.h>
#include <osteomill/visual/image.h>
#include <osteomill/visual/mesh_file.h>
#include <osteomill/visual/surface_mesh.h>
#include <osteomill/volume/bone_densities.h>
#include <osteomill/volume/builtin_tooth.h>
#include <osteomill/volume/isovalue.h>

namespace {

// Returns a view of the whole surface from the patient's front.
osteomill::Camera camera_before(const osteomill::BrickMesh& surface) {
  Eigen::AlignedBox3d box;
  for (const osteomill::MeshVertex& vertex : surface.vertices) {
    box.extend(osteomill::vec3_of(vertex.position_mm));
  }
  const osteomill::PatientView& front = osteomill::kPatientViews[0];
  return osteomill::camera_on({box.center(), 0.5 * box.diagonal().norm()}, front.direction_W, front.up_W);
}

}  // namespace

int main(int argc, char** argv) try {
  osteomill::Scan scan = argc > 1 ? osteomill::read_scan(argv[1])
                                  : osteomill::Scan{osteomill::builtin_tooth(), "built-in tooth", "made up"};
  for (const std::string& warning : scan.warnings) std::puts(warning.c_str());
  const osteomill::SuggestedIsovalue isovalue =
      osteomill::suggest_isovalue(scan.grid, scan.in_hounsfield_units);
  std::printf("isovalue %g: %s\n", isovalue.value, isovalue.how.c_str());

  const osteomill::Volume bone(std::move(scan.grid), isovalue.value);
  const osteomill::BrickMesh surface = osteomill::mesh_in_one_piece(osteomill::DensityView(bone));
  osteomill::write_mesh("bone.stl", surface);
  std::printf("bone.stl: %zu triangles\n", surface.triangle_count());
  if (surface.empty()) return 1;

  const osteomill::BoneDensities densities = osteomill::estimate_densities(bone);
  osteomill::write_png("bone.png",
                       osteomill::bone_picture(bone, densities.reference, camera_before(surface)));
  return 0;
} catch (const std::exception& error) {  // an InputError names the file; without OpenGL there is no picture
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
