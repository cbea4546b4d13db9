// Meshes one scan at 512 x 512 x 352 with osteomill and with VTK's vtkFlyingEdges3D, in turns, and prints
// both.
//   surface_against_vtk [SCAN ISOVALUE]        without a scan, the built-in tooth
// A scan is refined twice by trilinear interpolation.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "osteomill/ct/read_scan.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/surface/surface_mesh.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/densities.h"
#include "osteomill/volume/isosurface.h"
#include "osteomill/volume/sampling.h"

namespace {

using namespace osteomill;

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

template <typename Work>
double milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

class Times {
 public:
  void add(double ms) { ms_.push_back(ms); }
  double least() const { return *std::min_element(ms_.begin(), ms_.end()); }
  double share(double part) const {
    std::vector<double> sorted = ms_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  }

 private:
  std::vector<double> ms_;
};

vtkNew<vtkImageData> share_with_vtk(const Volume& volume) {
  const GridGeometry& geometry = volume.geometry();
  vtkNew<vtkImageData> image;
  image->SetDimensions(geometry.dims[0], geometry.dims[1], geometry.dims[2]);
  image->SetSpacing(geometry.spacing_mm.x(), geometry.spacing_mm.y(), geometry.spacing_mm.z());
  vtkNew<vtkFloatArray> densities;
  const std::vector<float>& values = volume.grid().densities();
  densities->SetArray(const_cast<float*>(values.data()), static_cast<vtkIdType>(values.size()), 1);
  image->GetPointData()->SetScalars(densities);
  return image;
}

std::size_t triangles_in(const SurfaceMesh& mesh) {
  std::size_t count = 0;
  for (const BrickMesh& brick : mesh.bricks) count += brick.triangle_count();
  return count;
}

// The top of the bone over its middle, and a burr pressed on it with 4 N for a frame of 33 ms.
class Milling {
 public:
  explicit Milling(Volume& volume)
      : volume_(volume), mill_(volume.geometry(), kRadius_mm, estimate_densities(volume), {}) {
    const GridGeometry& geometry = volume.geometry();
    const Vec3 middle(geometry.dims[0] / 2.0, geometry.dims[1] / 2.0, 0);
    const Vec3 top(middle.x(), middle.y(), geometry.dims[2]);
    into_ = (geometry.world_from_voxel(middle) - geometry.world_from_voxel(top)).normalized();
    const auto touched =
        first_crossing(volume, geometry.world_from_voxel(top), geometry.world_from_voxel(middle));
    if (!touched) std::exit((std::fprintf(stderr, "no bone over the middle of the scan\n"), 1));
    centre_ = *touched - into_ * kRadius_mm;
  }
  VoxelBox frame() {
    VoxelBox changed;
    for (int tick = 0; tick < 33; ++tick) {
      const VoxelBox voxels = mill_.step(volume_, centre_, 4.0, 1e-3).change.voxels;
      if (!voxels.empty()) {
        changed.include(voxels.first);
        changed.include(voxels.last);
      }
      centre_ += into_ * 0.001;
    }
    return changed;
  }

 private:
  static constexpr double kRadius_mm = 1.5;
  Volume& volume_;
  BurrMill mill_;
  Vec3 into_;
  Vec3 centre_;
};

}  // namespace

int main(int argc, char** argv) {
  Volume volume = make_volume(argc, argv);
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
  setenv("VTK_SMP_MAX_THREADS", "1", 1);
  const vtkNew<vtkImageData> image = share_with_vtk(volume);
  vtkNew<vtkFlyingEdges3D> flying;
  flying->SetInputData(image);
  flying->SetValue(0, volume.isovalue());
  flying->ComputeNormalsOn();
  flying->ComputeGradientsOff();
  flying->ComputeScalarsOff();

  Times vtk, one, two;
  std::size_t triangles = 0;
  for (int n = 0; n < 7; ++n) {
    vtk.add(milliseconds([&] { flying->Modified(), flying->Update(); }));
    SurfaceMesh mesh;
    one.add(milliseconds([&] { mesh = mesh_surface(DensityView(volume), 1); }));
    triangles = triangles_in(mesh);
    mesh = {};
    two.add(milliseconds([&] { mesh = mesh_surface(DensityView(volume), 2); }));
  }
  const auto& dims = volume.geometry().dims;
  std::printf("%d x %d x %d: %zu triangles (VTK: %lld)\n", dims[0], dims[1], dims[2], triangles,
              static_cast<long long>(flying->GetOutput()->GetNumberOfPolys()));
  std::printf(
      "whole surface, ms (least / median): VTK %.1f / %.1f, osteomill %.1f / %.1f, two threads %.1f / %.1f\n",
      vtk.least(), vtk.share(0.5), one.least(), one.share(0.5), two.least(), two.share(0.5));

  Milling milling(volume);
  const SurfaceBricks layout(dims);
  Times vtk_edit, edit;
  for (int n = 0; n < 60; ++n) {
    const VoxelBox bricks = layout.touched_by(milling.frame());
    if (n % 20 == 0) vtk_edit.add(milliseconds([&] { flying->Modified(), flying->Update(); }));
    std::vector<BrickMesh> meshes;
    edit.add(milliseconds([&] {
      for (int bk = bricks.first.k; bk <= bricks.last.k; ++bk)
        for (int bj = bricks.first.j; bj <= bricks.last.j; ++bj)
          for (int bi = bricks.first.i; bi <= bricks.last.i; ++bi)
            meshes.push_back(mesh_brick(DensityView(volume), layout.index(bi, bj, bk)));
    }));
  }
  std::printf("a frame's milling, ms (least / median): VTK %.1f / %.1f, osteomill %.2f / %.2f, p99 %.2f\n",
              vtk_edit.least(), vtk_edit.share(0.5), edit.least(), edit.share(0.5), edit.share(0.99));
  std::printf("faster than VTK: whole %.1f times, edit %.0f times\n", vtk.share(0.5) / one.share(0.5),
              vtk_edit.share(0.5) / edit.share(0.5));
}
