#include "osteomill/exercise/region_voxels.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/volume/nearest_voxels.h"
#include "osteomill/volume/sampling.h"
#include "osteomill/volume/structure_distance.h"

namespace osteomill {

namespace {

// Larger than any scan, and still within the range of int.
constexpr double kMaxNumber = 1e8;

/// A shape in voxels: its bounding box, and a membership test within it.
struct ShapeVoxels {
  VoxelBox box;
  std::function<bool(const VoxelIndex&)> contains;
};

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

VoxelBox box_about(const GridGeometry& grid, std::initializer_list<Vec3> points_W, double radius_mm = 0) {
  Vec3 low = Vec3::Constant(kMaxNumber), high = Vec3::Constant(-kMaxNumber);
  for (const Vec3& point_W : points_W) {
    const Vec3 point = grid.voxel_from_world(point_W);
    const Vec3 radius = Vec3::Constant(radius_mm).cwiseQuotient(grid.spacing_mm);
    low = low.cwiseMin(point - radius);
    high = high.cwiseMax(point + radius);
  }
  const auto whole = [](const Vec3& v) {
    const Vec3 in_range = v.cwiseMax(-kMaxNumber).cwiseMin(kMaxNumber);
    return VoxelIndex{static_cast<int>(in_range.x()), static_cast<int>(in_range.y()),
                      static_cast<int>(in_range.z())};
  };
  return {whole(low.array().ceil()), whole(high.array().floor())};
}

class Finder {
 public:
  Finder(const Region& region, const Volume& scan, const std::filesystem::path& file)
      : region_(region), scan_(scan), file_(file) {}

  VoxelSet find() const {
    std::vector<ShapeVoxels> shapes;
    VoxelBox box = grid().all_voxels();
    for (const Shape& shape : region_.shapes) {
      if (std::holds_alternative<ShellShape>(shape)) continue;
      shapes.push_back(std::visit([&](const auto& one) { return voxels_of(one); }, shape));
      box = box.intersected(shapes.back().box);
    }
    if (box.empty()) return {};
    // Shells come last: they are evaluated only within the other shapes.
    for (const Shape& shape : region_.shapes)
      if (const auto* shell = std::get_if<ShellShape>(&shape)) shapes.push_back(layer(*shell, box));
    VoxelSet found(box);
    for_each(box, [&](const VoxelIndex& v) {
      if (std::ranges::all_of(shapes, [&](const ShapeVoxels& shape) { return shape.contains(v); }))
        found.insert(v);
    });
    return found;
  }

 private:
  const GridGeometry& grid() const { return scan_.geometry(); }
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(file_.string(), fmt::format("line {}: {}", region_.line, reason));
  }

  template <typename Solid>
  ShapeVoxels solid(const Solid& shape, const VoxelBox& about, const char* what) const {
    const VoxelBox box = about.intersected(grid().all_voxels());
    if (box.empty()) refuse(fmt::format("the {} lies outside the scan", what));
    return {box, [this, shape](const VoxelIndex& v) {
              return distance_mm(shape, grid().world_from_voxel(v)) <= 0;
            }};
  }
  ShapeVoxels voxels_of(const BoxShape& box) const {
    const Vec3 &a = box.min_W, &b = box.max_W;
    const VoxelBox about = box_about(grid(), {a,
                                              b,
                                              {b.x(), a.y(), a.z()},
                                              {a.x(), b.y(), a.z()},
                                              {a.x(), a.y(), b.z()},
                                              {a.x(), b.y(), b.z()},
                                              {b.x(), a.y(), b.z()},
                                              {b.x(), b.y(), a.z()}});
    return solid(box, about, "box");
  }
  ShapeVoxels voxels_of(const SphereShape& sphere) const {
    return solid(sphere, box_about(grid(), {sphere.center_W}, sphere.radius_mm), "sphere");
  }
  ShapeVoxels voxels_of(const CylinderShape& cylinder) const {
    return solid(cylinder, box_about(grid(), {cylinder.from_W, cylinder.to_W}, cylinder.radius_mm),
                 "cylinder");
  }
  ShapeVoxels voxels_of(const OutsideConeShape& cone) const {
    const Vec3 axis = cone.to_W - cone.from_W;
    return {grid().all_voxels(), [this, cone, axis](const VoxelIndex& v) {
              const Vec3 from_start = grid().world_from_voxel(v) - cone.from_W;
              const double along = from_start.dot(axis) / axis.squaredNorm();
              if (along < 0 || along > 1) return true;
              const double radius_mm = cone.radius_mm + along * (cone.radius_to_mm - cone.radius_mm);
              return (from_start - along * axis).norm() > radius_mm;
            }};
  }
  ShapeVoxels voxels_of(const ShellShape&) const { return {}; }

  ShapeVoxels voxels_of(const LabelShape& named) const {
    const std::shared_ptr<const LabelMap> map = scan_.labels();
    if (!map) refuse(fmt::format("there is no label map that has {}", named.label));
    const std::string name = in_lower_case(named.label);
    for (std::size_t n = 0; n < map->labels().size(); ++n) {
      const Label& label = map->labels()[n];
      if (in_lower_case(label.name) != name && std::to_string(label.value) != name) continue;
      const auto index = static_cast<LabelMap::LabelIndex>(n + 1);
      return {map->box(), [map, index](const VoxelIndex& v) { return map->at(v) == index; }};
    }
    std::string known;
    constexpr std::size_t kShown = 8;
    for (std::size_t n = 0; n < std::min(kShown, map->labels().size()); ++n)
      known += (n > 0 ? ", " : "") + map->labels()[n].name;
    if (map->labels().size() > kShown) known += ", ...";
    refuse(fmt::format("{} is not in the label map, which has {}", named.label, known));
  }

  ShapeVoxels voxels_of(const RecordedShape& recorded) const {
    std::vector<VoxelSet> removed;
    VoxelBox box;
    for (const std::filesystem::path& path : recorded.recordings) {
      Volume milled = scan_;
      repeat_milling(milled, read_recording_chain(file_.parent_path() / path));
      removed.push_back(removed_voxels(scan_, milled));
      const VoxelBox& one = removed.back().box();
      if (one.empty()) continue;
      box.include(one.first);
      box.include(one.last);
    }
    const int at_least = recorded.at_least;
    return {box, [removed = std::move(removed), at_least](const VoxelIndex& v) {
              return std::ranges::count_if(removed, [&](const VoxelSet& one) { return one.contains(v); }) >=
                     at_least;
            }};
  }

  ShapeVoxels layer(const ShellShape& shell, const VoxelBox& box) const {
    const Vec3& spacing_mm = grid().spacing_mm;
    const auto voxels = static_cast<int>(std::ceil(shell.thickness_mm / spacing_mm.minCoeff())) + 1;
    const NearestVoxels open(open_space(scan_), box.grown(voxels).intersected(grid().all_voxels()),
                             spacing_mm);
    VoxelSet near(box);
    for_each(box, [&](const VoxelIndex& v) {
      if (!scan_.is_bone(v) || open.distance_mm(v) > shell.thickness_mm + spacing_mm.maxCoeff()) return;
      if (open.distance_mm(v) - above_surface_mm(open.nearest_to(v)) <= shell.thickness_mm) near.insert(v);
    });
    return {box, [near = std::move(near)](const VoxelIndex& v) { return near.contains(v); }};
  }

  // Returns the distance of a voxel's centre from the bone surface next to it, mm, from the density gradient.
  double above_surface_mm(const VoxelIndex& open) const {
    const double half_mm = 0.5 * grid().spacing_mm.minCoeff();
    const double slope = density_gradient(scan_.grid(), grid().world_from_voxel(open)).norm();
    const double rise = scan_.isovalue() - static_cast<double>(scan_.grid()[open]);
    return slope > 0 ? std::clamp(rise / slope, 0.0, 2 * half_mm) : half_mm;
  }

  const Region& region_;
  const Volume& scan_;
  const std::filesystem::path& file_;
};

}  // namespace

VoxelSet region_voxels(const Region& region, const Volume& scan, const std::filesystem::path& file) {
  return Finder(region, scan, file).find();
}

VoxelSet removed_voxels(const Volume& before, const Volume& after) {
  const auto is_removed = [&](const VoxelIndex& v) { return before.is_bone(v) && !after.is_bone(v); };
  VoxelBox box;
  for_each_bone_voxel(before, [&](const VoxelIndex& v) {
    if (!after.is_bone(v)) box.include(v);
  });
  VoxelSet removed(box);
  for_each(box, [&](const VoxelIndex& v) {
    if (is_removed(v)) removed.insert(v);
  });
  return removed;
}

namespace {

// Flood-fills the face-connected space from a voxel into `found`, and calls `use` for each added voxel.
template <typename IsSpace, typename Use>
void flood(VoxelSet& found, const VoxelIndex& start, const IsSpace& is_space, const Use& use) {
  std::vector<VoxelIndex> pending;
  const auto enter = [&](const VoxelIndex& v) {
    if (!found.box().contains(v) || found.contains(v) || !is_space(v)) return;
    found.insert(v);
    pending.push_back(v);
  };
  enter(start);
  constexpr std::size_t kBetweenReports = 1 << 20;
  for (std::size_t visited = 1; !pending.empty(); ++visited) {
    if (visited % kBetweenReports == 0) WorkProgress::done(0);
    const VoxelIndex v = pending.back();
    pending.pop_back();
    use(v);
    for (const int step : {-1, 1}) {
      enter({v.i + step, v.j, v.k});
      enter({v.i, v.j + step, v.k});
      enter({v.i, v.j, v.k + step});
    }
  }
}

}  // namespace

VoxelSet open_space(const Volume& bone, const VoxelSet& walls) {
  const VoxelBox all = bone.geometry().all_voxels();
  VoxelSet open(all);
  const auto is_space = [&](const VoxelIndex& v) { return !bone.is_bone(v) && !walls.contains(v); };
  for_each(all, [&](const VoxelIndex& v) {
    if (v.i == 0 || v.j == 0 || v.k == 0 || v.i == all.last.i || v.j == all.last.j || v.k == all.last.k)
      flood(open, v, is_space, [](const VoxelIndex&) {});
  });
  return open;
}

VoxelSet opened_space(const Volume& bone, const VoxelSet& open_before, const VoxelSet& removed,
                      const VoxelSet& walls) {
  const VoxelBox all = bone.geometry().all_voxels();
  const auto is_space = [&](const VoxelIndex& v) { return !bone.is_bone(v) && !walls.contains(v); };
  const auto is_reached = [&](const VoxelIndex& v) {
    const auto is_open = [&](int i, int j, int k) {
      const VoxelIndex beside{v.i + i, v.j + j, v.k + k};
      return !all.contains(beside) || open_before.contains(beside);
    };
    return is_open(-1, 0, 0) || is_open(1, 0, 0) || is_open(0, -1, 0) || is_open(0, 1, 0) ||
           is_open(0, 0, -1) || is_open(0, 0, 1);
  };
  VoxelSet open = open_before;
  std::vector<VoxelIndex> found;
  VoxelBox box;
  removed.for_each([&](const VoxelIndex& v) {
    if (!is_reached(v)) return;
    flood(open, v, is_space, [&](const VoxelIndex& one) {
      found.push_back(one);
      box.include(one);
    });
  });
  VoxelSet opened(box);
  for (const VoxelIndex& v : found) opened.insert(v);
  return opened;
}

bool is_cut_through(const VoxelSet& structure, const Volume& before, const Volume& after) {
  VoxelBox held;
  bool is_cut = false;
  structure.for_each([&](const VoxelIndex& v) {
    held.include(v);
    is_cut = is_cut || (before.is_bone(v) && !after.is_bone(v));
  });
  if (!is_cut) return false;
  const VoxelBox box = held.grown(1).intersected(before.geometry().all_voxels());
  // Bone removed next to the structure does not open a passage through it.
  const auto is_space = [&](const Volume& within) {
    return [&](const VoxelIndex& v) { return !(structure.contains(v) ? within : after).is_bone(v); };
  };
  std::vector<int> number_beside(cell_count(box.dims()), 0);
  const auto place = [&, dims = box.dims()](const VoxelIndex& v) {
    return row_major(dims, v.i - box.first.i, v.j - box.first.j, v.k - box.first.k);
  };
  VoxelSet was(box), is(box);
  int number = 0;
  for_each(box, [&](const VoxelIndex& start) {
    ++number;
    flood(was, start, is_space(before), [&](const VoxelIndex& v) {
      if (!structure.contains(v)) number_beside[place(v)] = number;
    });
  });
  bool is_joined = false;
  for_each(box, [&](const VoxelIndex& start) {
    int first = 0;
    flood(is, start, is_space(after), [&](const VoxelIndex& v) {
      const int beside = number_beside[place(v)];
      if (beside == 0) return;
      is_joined = is_joined || (first != 0 && first != beside);
      first = beside;
    });
  });
  return is_joined;
}

VoxelSet bone_within(const VoxelSet& voxels, const Volume& bone) {
  VoxelSet found(voxels.box());
  voxels.for_each([&](const VoxelIndex& v) {
    if (bone.is_bone(v)) found.insert(v);
  });
  return found;
}

}  // namespace osteomill
