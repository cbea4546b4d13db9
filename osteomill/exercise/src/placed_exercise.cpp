#include "osteomill/exercise/placed_exercise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "osteomill/base/input_error.h"
#include "osteomill/exercise/measures.h"
#include "osteomill/exercise/region_voxels.h"

namespace osteomill {

namespace {

[[noreturn]] void refuse(const Exercise& exercise, int line, const std::string& reason) {
  throw InputError(exercise.file.string(), fmt::format("line {}: {}", line, reason));
}

VoxelSet within_margin(const VoxelSet& target, const GridGeometry& scan, double margin_mm) {
  const auto voxels = static_cast<int>(std::ceil(margin_mm / scan.spacing_mm.minCoeff()));
  const NearestVoxels nearest(target, target.box().grown(voxels).intersected(scan.all_voxels()),
                              scan.spacing_mm);
  VoxelSet allowed(nearest.box());
  for_each(nearest.box(), [&](const VoxelIndex& v) {
    if (nearest.distance_mm(v) <= margin_mm) allowed.insert(v);
  });
  return allowed;
}

// Returns an axis, because walls of fissures tilt the mean normal: z for targets reached from above.
Vec3 outward_of(const VoxelSet& target, const Volume& scan) {
  Vec3 sum_W = Vec3::Zero();
  target.for_each([&](const VoxelIndex& v) {
    for (const int step : {-1, 1}) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const Vec3 along = step * Vec3::Unit(axis);
        const VoxelIndex beside{v.i + static_cast<int>(along.x()), v.j + static_cast<int>(along.y()),
                                v.k + static_cast<int>(along.z())};
        if (!scan.is_bone_in_grid(beside)) sum_W += scan.geometry().direction * along;
      }
    }
  });
  if (!(sum_W.norm() > 0)) return Vec3::UnitZ();
  Eigen::Index axis = 2;
  if (std::abs(sum_W.z()) <= 0.5 * sum_W.norm()) sum_W.head<2>().cwiseAbs().maxCoeff(&axis);
  return std::copysign(1.0, sum_W[axis]) * Vec3::Unit(axis);
}

// Measures a single solid exactly, everything else by its voxels.
StructureDistance distance_of(const Region& region, const VoxelSet& voxels, const GridGeometry& scan) {
  if (region.shapes.size() == 1) {
    const Shape& shape = region.shapes.front();
    if (const auto* box = std::get_if<BoxShape>(&shape)) return StructureDistance(*box);
    if (const auto* sphere = std::get_if<SphereShape>(&shape)) return StructureDistance(*sphere);
    if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) return StructureDistance(*cylinder);
  }
  return {voxels, scan};
}

PlacedStructure place_structure(const NoGoStructure& structure, const PlacedExercise& placed,
                                const Volume& scan, NoGoDistances& distances) {
  const Exercise& exercise = placed.exercise;
  VoxelSet voxels = region_voxels(structure.region, scan, exercise.file);
  if (voxels.empty())
    refuse(exercise, structure.region.line, fmt::format("{} holds no voxel of the scan", structure.name));
  distances.push_back({distance_of(structure.region, voxels, scan.geometry()), structure.guard_mm});
  const StructureDistance& distance = distances.back().distance;
  std::size_t shared = 0;
  double least_mm = std::numeric_limits<double>::infinity();
  placed.target.for_each([&](const VoxelIndex& v) {
    if (voxels.contains(v)) ++shared;
    least_mm = std::min(least_mm, distance.from(scan.geometry().world_from_voxel(v)));
  });
  if (shared > 0) {
    refuse(exercise, exercise.target.line,
           fmt::format("the target overlaps {}, which must not be touched, by {:.4g} mm³", structure.name,
                       placed.volume_mm3(shared)));
  }
  return {structure.name, structure.warn_mm, structure.guard_mm, std::move(voxels), least_mm};
}

std::string limits_text(const ExerciseItem& item, const std::string& unit) {
  std::string text;
  if (item.at_least) text = fmt::format("at least {:g}", *item.at_least);
  if (item.at_most) text += fmt::format("{}at most {:g}", item.at_least ? " and " : "", *item.at_most);
  return unit.empty() ? text : text + " " + unit;
}

}  // namespace

PlacedExercise place_exercise(const Exercise& exercise, const Volume& scan) {
  PlacedExercise placed;
  placed.exercise = exercise;
  placed.scan = scan.geometry();
  placed.target = bone_within(region_voxels(exercise.target, scan, exercise.file), scan);
  if (placed.target.empty()) refuse(exercise, exercise.target.line, "the target holds no bone");
  placed.outward_W = outward_of(placed.target, scan);
  placed.allowed = within_margin(placed.target, scan.geometry(), exercise.margin_mm);
  if (exercise.keep) {
    placed.keep = bone_within(region_voxels(*exercise.keep, scan, exercise.file), scan);
    if (placed.keep.empty()) refuse(exercise, exercise.keep->line, "keep holds no bone");
    placed.target.for_each([&](const VoxelIndex& v) {
      if (placed.keep.contains(v))
        refuse(exercise, exercise.keep->line, "the target overlaps the bone to be kept");
    });
  }
  auto distances = std::make_shared<NoGoDistances>();
  for (const NoGoStructure& structure : exercise.no_go)
    placed.structures.push_back(place_structure(structure, placed, scan, *distances));
  placed.distances = std::move(distances);
  for (const ExerciseStep& step : exercise.steps) {
    placed.steps.push_back(bone_within(region_voxels(step.region, scan, exercise.file), scan));
    if (placed.steps.back().empty()) refuse(exercise, step.region.line, "the step's region holds no bone");
  }
  return placed;
}

std::shared_ptr<const LabelMap> colours_of(const PlacedExercise& placed) {
  constexpr std::array<std::uint8_t, 3> kTarget{70, 190, 110}, kKeep{90, 140, 230};
  constexpr std::array<std::array<std::uint8_t, 3>, 4> kNoGo{
      {{235, 80, 60}, {240, 150, 40}, {215, 70, 160}, {160, 90, 220}}};
  std::vector<Label> labels{{1, "target", kTarget}};
  std::vector<LabelMap::LabelIndex> places(placed.scan.voxel_count(), 0);
  const auto colour = [&](const VoxelSet& voxels) {
    voxels.for_each([&](const VoxelIndex& v) {
      places[row_major(placed.scan.dims, v.i, v.j, v.k)] = static_cast<LabelMap::LabelIndex>(labels.size());
    });
  };
  colour(placed.target);
  labels.push_back({2, "bone to be kept", kKeep});
  colour(placed.keep);
  for (std::size_t n = 0; n < placed.structures.size() && labels.size() < LabelMap::kMaxLabels; ++n) {
    labels.push_back({static_cast<int>(n + 3), placed.structures[n].name, kNoGo[n % kNoGo.size()], true});
    colour(placed.structures[n].voxels);
  }
  return std::make_shared<const LabelMap>(std::move(labels), placed.scan, placed.scan, places);
}

std::vector<std::string> describe(const PlacedExercise& placed) {
  const Exercise& exercise = placed.exercise;
  const auto volume = [&](const VoxelSet& voxels) {
    return fmt::format("{:.4g} mm³", placed.volume_mm3(voxels.count()));
  };
  std::vector<std::string> lines{exercise.title};
  if (!exercise.task.empty()) lines.push_back("task: " + in_one_line(exercise.task));
  lines.push_back("target: " + volume(placed.target) + " of bone");
  if (exercise.margin_mm > 0)
    lines.push_back(fmt::format("keep: bone more than {:g} mm outside the target", exercise.margin_mm));
  if (exercise.keep) lines.push_back("keep: " + volume(placed.keep) + " of bone wherever it lies");
  for (const PlacedStructure& structure : placed.structures) {
    lines.push_back(fmt::format("no-go {}: {}, {:.2f} mm from the target, warning below {:g} mm",
                                structure.name, volume(structure.voxels), structure.from_target_mm,
                                structure.warn_mm));
    if (structure.guard_mm) lines.back() += fmt::format(", burr held off by {:g} mm", *structure.guard_mm);
  }
  if (exercise.entry_W_mm)
    lines.push_back(fmt::format("entry: {:g}, {:g}, {:g} mm", exercise.entry_W_mm->x(),
                                exercise.entry_W_mm->y(), exercise.entry_W_mm->z()));
  std::vector<std::string> burrs;
  for (const AllowedBurr& burr : exercise.burrs) burrs.push_back(burr.label());
  if (!burrs.empty()) lines.push_back(fmt::format("tools: burrs {}", fmt::join(burrs, ", ")));
  if (exercise.time_s) lines.push_back(fmt::format("time: {:g} s", *exercise.time_s));
  for (std::size_t n = 0; n < exercise.steps.size(); ++n) {
    lines.push_back(fmt::format("step {}: {} ({} of bone, done at {:g} %)", n + 1,
                                in_one_line(exercise.steps[n].text), volume(placed.steps[n]),
                                exercise.steps[n].done_percent));
  }
  for (const ExerciseItem& item : exercise.items) {
    const Measure* measure = find_measure(item.measure);
    lines.push_back(fmt::format("item {}{}: {}{}", item.measure, item.part.empty() ? "" : " of " + item.part,
                                limits_text(item, measure != nullptr ? measure->unit : ""),
                                item.source.empty() ? "" : " (" + item.source + ")"));
  }
  return lines;
}

}  // namespace osteomill
