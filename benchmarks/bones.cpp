#include "benchmarks/bones.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::benchmarks {

namespace {

constexpr double kRealToothIsovalue = 755;
const std::filesystem::path kRealTooth = std::filesystem::path(OSTEOMILL_SHARED_DATA) / "tooth_dicom/series";

// Returns the grid with twice the resolution along each axis and the same extent.
DensityGrid refined(const DensityGrid& coarse) {
  GridGeometry geometry = coarse.geometry();
  geometry.origin_mm = geometry.world_from_voxel(Vec3::Constant(-0.25).eval());
  geometry.spacing_mm *= 0.5;
  for (int& dim : geometry.dims) dim *= 2;
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const Vec3 voxel = Vec3(0.5 * i - 0.25, 0.5 * j - 0.25, 0.5 * k - 0.25);
        densities.push_back(static_cast<float>(density_at_voxel(coarse, voxel)));
      }
    }
  }
  return DensityGrid(geometry, std::move(densities));
}

Volume make(Bone bone) {
  switch (bone) {
    case Bone::builtin:
      return Volume(builtin_tooth(), kBuiltinToothIsovalue);
    case Bone::builtin_refined:
      return Volume(builtin_tooth(2.0), kBuiltinToothIsovalue);
    case Bone::builtin_finest:
      return Volume(builtin_tooth(4.0), kBuiltinToothIsovalue);
    case Bone::real_tooth:
      return Volume(read_scan(kRealTooth).grid, kRealToothIsovalue);
    case Bone::real_tooth_refined:
      break;
  }
  return Volume(refined(bone_volume(Bone::real_tooth).grid()), kRealToothIsovalue);
}

}  // namespace

std::string name_of(Bone bone) {
  switch (bone) {
    case Bone::builtin:
      return "builtin_256";
    case Bone::builtin_refined:
      return "builtin_512";
    case Bone::builtin_finest:
      return "builtin_1024";
    case Bone::real_tooth:
      return "tooth_256";
    case Bone::real_tooth_refined:
      break;
  }
  return "tooth_512";
}

bool is_available(Bone bone) {
  const bool is_real = bone == Bone::real_tooth || bone == Bone::real_tooth_refined;
  return !is_real || std::filesystem::exists(kRealTooth);
}

const Volume& bone_volume(Bone bone) {
  static std::map<Bone, std::unique_ptr<Volume>> made;
  std::unique_ptr<Volume>& volume = made[bone];
  if (!volume) volume = std::make_unique<Volume>(make(bone));
  return *volume;
}

Volume sleeve_block(double spacing_mm, const MillingTool& tool, double overlap_mm) {
  constexpr double kMargin_voxels = 4;
  GridGeometry geometry;
  geometry.dims = {512, 512, 352};
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  const Vec3 half = 0.5 * spacing_mm * Vec3(511, 511, 351);
  geometry.origin_mm = -half;
  const double hole_mm = tool.shaft_radius_mm - overlap_mm;
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      const Vec3 row = geometry.world_from_voxel(VoxelIndex{0, j, k});
      const double in_hole = hole_mm - std::hypot(row.y(), row.z());
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const Vec3 p(row.x() + i * spacing_mm, row.y(), row.z());
        const double out_of_block = (p.cwiseAbs() - half).maxCoeff() + kMargin_voxels * spacing_mm;
        const double distance = std::max(in_hole, out_of_block);
        densities.push_back(
            static_cast<float>(1000 * std::clamp(0.5 - 0.5 * distance / spacing_mm, 0.0, 1.0)));
      }
    }
  }
  return Volume(DensityGrid(geometry, std::move(densities)), 500);
}

Pose pose_in_sleeve(const Volume& block, const MillingTool& tool) {
  // Position of the burr's centre at which the whole shaft is in the hole, if it fits.
  const double half_block = 0.5 * block.geometry().spacing_mm.x() * (block.geometry().dims[0] - 9);
  const double start = std::max(-0.5 * tool.shaft_length_mm, -half_block);
  return {{start, 0, 0}, smallest_rotation(Vec3::UnitZ(), Vec3::UnitX())};
}

}  // namespace osteomill::benchmarks
