// Meshes one scan at 512 x 512 x 352 alternately with osteomill and with VTK's vtkFlyingEdges3D, and prints
// both times.
//   surface_against_vtk [SCAN ISOVALUE]        default: the built-in tooth
// A scan is refined twofold by trilinear interpolation.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <span>
#include <utility>
#include <vector>

#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "osteomill/base/distribution.h"
#include "osteomill/ct/read_scan.h"
#include "osteomill/live/bone_follower.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/visual/surface_mesh.h"
#include "osteomill/visual/surface_upkeep.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/editable_volume.h"
#include "osteomill/volume/sampling.h"

#include "tests/support/mesh_checks.h"

namespace {

using namespace osteomill;
using testing_support::mesh_surface;
using testing_support::SurfaceMesh;

DensityGrid refined(const DensityGrid& grid) {
  GridGeometry geometry = grid.geometry();
  for (int& count : geometry.dims) count *= 2;
  geometry.spacing_mm /= 2;
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) {
        densities.push_back(static_cast<float>(density_at_voxel(grid, Vec3(i, j, k) / 2)));
      }
    }
  }
  return DensityGrid(geometry, std::move(densities));
}

Volume make_volume(int argc, char** argv) {
  if (argc < 3) return Volume(builtin_tooth(2), kBuiltinToothIsovalue);
  return Volume(refined(read_scan(argv[1]).grid), std::atof(argv[2]));
}

double seconds_on(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Returns this thread's CPU time, which other work on the machine affects little.
template <typename Work>
double milliseconds(const Work& work) {
  const double start = seconds_on(CLOCK_THREAD_CPUTIME_ID);
  work();
  return 1e3 * (seconds_on(CLOCK_THREAD_CPUTIME_ID) - start);
}

class Times {
 public:
  void add(double ms) { ms_.push_back(ms); }
  double share(double part) const { return percentile(ms_, part); }

 private:
  std::vector<double> ms_;
};

vtkNew<vtkImageData> image_for_vtk(const Volume& volume) {
  const GridGeometry& geometry = volume.geometry();
  vtkNew<vtkImageData> image;
  image->SetDimensions(geometry.dims[0], geometry.dims[1], geometry.dims[2]);
  image->SetSpacing(geometry.spacing_mm.x(), geometry.spacing_mm.y(), geometry.spacing_mm.z());
  vtkNew<vtkFloatArray> densities;
  for_each_row(volume.grid(), [&](std::span<const float> row) {
    for (const float density : row) densities->InsertNextValue(density);
  });
  image->GetPointData()->SetScalars(densities);
  return image;
}

std::size_t triangles_in(const SurfaceMesh& mesh) {
  std::size_t count = 0;
  for (const BrickMesh& brick : mesh.bricks) count += brick.triangle_count();
  return count;
}

// A burr pressed with 4 N on top of the bone at its middle, and lowered at 1 mm/s.
class Milling {
 public:
  Milling(Volume& volume, double radius_mm) : mill_(volume, radius_mm, estimate_densities(volume), {}) {
    const GridGeometry& geometry = volume.geometry();
    const Vec3 foot = geometry.world_from_voxel(Vec3(geometry.dims[0] / 2.0, geometry.dims[1] / 2.0, 0));
    const Vec3 top = foot + geometry.direction.col(2) * geometry.spacing_mm.z() * geometry.dims[2];
    into_ = (foot - top).normalized();
    const auto touched = first_crossing(volume, top, foot);
    if (!touched) std::exit((std::fprintf(stderr, "no bone over the middle of the scan\n"), 1));
    centre_ = *touched - into_ * radius_mm;
  }
  VolumeChange tick() {
    centre_ += into_ * 0.001;
    return mill_.step(centre_, {0, 0, -4.0}, 1e-3).change;
  }

 private:
  BurrMill mill_;
  Vec3 into_;
  Vec3 centre_;
};

struct FrameTimes {
  Times handing_over_us;  // a tick
  Times meshing;          // a frame of 33 ticks
  Times vtk;
  Times bricks;
};

FrameTimes mill_and_mesh(const Volume& bone, double radius_mm, vtkFlyingEdges3D* flying) {
  constexpr int kFrames = 120;
  constexpr int kTicks = 33;
  Volume volume = bone;
  Milling milling(volume, radius_mm);
  DensityHandover handover(volume.geometry(), 512);
  Volume copy = bone;
  SurfaceUpkeep upkeep{SurfaceBricks(copy.geometry().dims)};
  upkeep.remesh(DensityView(copy));
  FrameTimes times;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int tick = 0; tick < kTicks; ++tick) {
      const VolumeChange change = milling.tick();
      times.handing_over_us.add(1e3 * milliseconds([&] {
                                  handover.mark(change);
                                  handover.send(volume, BoneFollower::kBricksPerTick);
                                }));
    }
    times.meshing.add(milliseconds([&] {
      while (DensityBlock* brick = handover.front()) {
        upkeep.mark(EditableVolume(copy).swap(*brick));
        handover.pop();
      }
      times.bricks.add(static_cast<double>(upkeep.remesh(DensityView(copy)).size()));
    }));
  }
  if (flying != nullptr) {
    const vtkNew<vtkImageData> image = image_for_vtk(volume);
    flying->SetInputData(image);
    for (int n = 0; n < 3; ++n) times.vtk.add(milliseconds([&] { flying->Modified(), flying->Update(); }));
  }
  return times;
}

void compare_whole(const Volume& volume, vtkFlyingEdges3D* flying) {
  Times vtk, own;
  std::size_t triangles = 0;
  for (int n = 0; n < 7; ++n) {
    vtk.add(milliseconds([&] { flying->Modified(), flying->Update(); }));
    SurfaceMesh mesh;
    own.add(milliseconds([&] { mesh = mesh_surface(DensityView(volume)); }));
    triangles = triangles_in(mesh);
  }
  const auto& dims = volume.geometry().dims;
  std::printf("%d x %d x %d voxels, %zu triangles (VTK: %lld)\n", dims[0], dims[1], dims[2], triangles,
              static_cast<long long>(flying->GetOutput()->GetNumberOfPolys()));
  std::printf("whole surface, one thread, CPU ms (least / median): VTK %.1f / %.1f, osteomill %.1f / %.1f\n",
              vtk.share(0), vtk.share(0.5), own.share(0), own.share(0.5));
  std::printf("              osteomill is %.1f times as fast\n", vtk.share(0.5) / own.share(0.5));
}

void compare_milling(const Volume& volume, double radius_mm, vtkFlyingEdges3D* flying) {
  const FrameTimes times = mill_and_mesh(volume, radius_mm, flying);
  std::printf(
      "burr of %g mm, 4 N, a frame of 33 ms, one thread, CPU ms (median / p99 / most): osteomill %.2f / "
      "%.2f / %.2f for %.0f bricks, VTK %.1f\n",
      2 * radius_mm, times.meshing.share(0.5), times.meshing.share(0.99), times.meshing.share(1),
      times.bricks.share(0.5), times.vtk.share(0.5));
  std::printf("              handed over in the tick, us (median / p99 / most): %.1f / %.1f / %.1f\n",
              times.handing_over_us.share(0.5), times.handing_over_us.share(0.99),
              times.handing_over_us.share(1));
  std::printf("              osteomill is %.0f times as fast\n",
              times.vtk.share(0.5) / times.meshing.share(0.5));
}

}  // namespace

int main(int argc, char** argv) {
  // Restricts VTK to one thread; must be set before its first use.
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
  setenv("VTK_SMP_MAX_THREADS", "1", 1);
  const Volume volume = make_volume(argc, argv);
  const vtkNew<vtkImageData> image = image_for_vtk(volume);
  vtkNew<vtkFlyingEdges3D> flying;
  flying->SetInputData(image);
  flying->SetValue(0, volume.isovalue());
  flying->ComputeNormalsOn();
  flying->ComputeGradientsOff();
  flying->ComputeScalarsOff();
  compare_whole(volume, flying);
  compare_milling(volume, 1.5, flying);
  compare_milling(volume, 3.0, flying);
}
