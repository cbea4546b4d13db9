#include "report/milled_bones.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/work_progress.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/study/bone_page.h"
#include "osteomill/visual/surface_mesh.h"
#include "osteomill/volume/editable_volume.h"

#include "report/report_parts.h"

namespace osteomill {

namespace {

constexpr std::size_t kMostRuns = 8, kFewestVertices = 1000;

// Region that runs cut, and the side on which the tool was held.
struct CutPlace {
  Eigen::AlignedBox3d box_W;
  Vec3 towards_hand_W = Vec3::Zero();

  void add(const Recording& recording) {
    double removed_mm3 = 0;
    auto next = recording.sessions.begin();
    for (std::size_t n = 0; n < recording.records.size(); ++n) {
      const TickRecord& record = recording.records[n];
      // Excludes cuts that were redone between two sessions rather than made by the tool.
      for (; next != recording.sessions.end() && next->first <= n; ++next)
        removed_mm3 = next->start.removed_mm3;
      if (std::exchange(removed_mm3, record.removed_mm3) >= record.removed_mm3) continue;
      box_W.extend(record.X_WT.position_mm);
      towards_hand_W += record.X_WT.orientation * Vec3::UnitZ();
    }
  }
  // Returns a ball about the cuts, or about the middle of the bone if nothing was cut.
  Sphere ball(const GridGeometry& scan, double burr_radius_mm) const {
    if (box_W.isEmpty()) {
      const Vec3 first_W = scan.world_from_voxel(scan.all_voxels().first),
                 last_W = scan.world_from_voxel(scan.all_voxels().last);
      return {0.5 * (first_W + last_W), 0.3 * (last_W - first_W).norm()};
    }
    return {box_W.center(), 0.5 * box_W.diagonal().norm() + 2 * burr_radius_mm};
  }
  Vec3 up_W() const { return towards_hand_W.norm() > 0 ? towards_hand_W.normalized() : Vec3::UnitZ(); }
};

// Returns the part of a bone about a position that fits into a page; all of it if it is small.
Volume part_about(const Volume& bone, const Vec3& place_W) {
  constexpr int kMostVoxels = 300;
  const GridGeometry& scan = bone.geometry();
  const Vec3 place = scan.voxel_from_world(place_W).array().round();
  const VoxelIndex middle{static_cast<int>(place.x()), static_cast<int>(place.y()),
                          static_cast<int>(place.z())};
  const VoxelBox box = VoxelBox{middle, middle}.grown(kMostVoxels / 2).intersected(scan.all_voxels());
  if (box == scan.all_voxels()) return bone;
  GridGeometry own = scan;
  own.dims = box.dims();
  own.origin_mm = scan.world_from_voxel(box.first);
  std::vector<float> densities;
  densities.reserve(own.voxel_count());
  for_each(box, [&](const VoxelIndex& v) { densities.push_back(bone.grid()[v]); });
  return {DensityGrid(own, std::move(densities)), bone.isovalue()};
}

// Returns the bone at the end of the recording.
Volume bone_after(const Volume& scan, const Recording& recording) {
  Volume bone = scan;
  repeat_milling(bone, recording);
  EditableVolume(bone).set_isovalue(recording.sessions.back().start.run.isovalue);
  return bone;
}

}  // namespace

MilledBones milled_bones(const RunGroup& group, const ScanOf& scan_of, std::size_t max_bytes) {
  MilledBones bones;
  std::vector<const MeasuredRun*> runs;
  CutPlace place;
  for (const MeasuredRun& run : group.runs) {
    const Recording& one = *run.recording;
    if (one.sessions.empty() || !one.sessions.front().start.continues_from.empty() ||
        one.description.scan_hash != group.runs.front().recording->description.scan_hash)
      continue;
    runs.push_back(&run);
    place.add(one);
  }
  if (runs.size() > kMostRuns) {
    bones.notices.push_back(
        fmt::format("3D shows the bones of the first {} of {} runs.", kMostRuns, runs.size()));
    runs.resize(kMostRuns);
  }
  const std::size_t most = std::min(kMaxVertices, max_bytes / kVertexBytes / (runs.size() + 1));
  if (runs.empty() || most < kFewestVertices) {
    bones.notices = {runs.empty() ? "No bone in 3D: the recordings continue others."
                                  : "No bone in 3D: the page would be over 5 MB."};
    return bones;
  }
  try {
    const std::shared_ptr<const Volume> scan = scan_of(*runs.front()->recording);
    const GridGeometry& geometry = scan->geometry();
    const Sphere ball = place.ball(geometry, runs.front()->recording->description.tool.burr_radius_mm);
    nlohmann::json data;
    const auto add = [&](const Volume& bone, std::string choice) {
      const BrickMesh mesh = mesh_in_one_piece(DensityView(part_about(bone, ball.centre_W)));
      data["bodies"].push_back(body_of({.name = "bone", .choice = std::move(choice)},
                                       simplified(mesh, most, geometry.spacing_mm.minCoeff(), ball)));
    };
    const auto is_only_one = [&](const MeasuredRun& run) {
      return std::ranges::count(runs, run.algorithm, &MeasuredRun::algorithm) == 1;
    };
    add(*scan, "before");
    for (const MeasuredRun* run : runs)
      add(bone_after(*scan, *run->recording),
          fmt::format("after {} ({:.1f} mm³ removed)",
                      is_only_one(*run) ? run->algorithm.label : run_name(*run), run->metrics.removed_mm3));
    put_view(data, ball, place.up_W());
    bones.data = std::move(data);
  } catch (const WorkStopped&) {
    throw;
  } catch (const std::exception& error) {
    // The rest of the page is useful without it.
    bones.notices = {fmt::format("No bone in 3D: {}.", error.what())};
  }
  return bones;
}

}  // namespace osteomill
