#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "osteomill/exercise/attempt.h"
#include "osteomill/exercise/exercise.h"
#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/density_grid.h"

#include "tests/shapes.h"

namespace osteomill::testing_support {

/// Returns bone below z = 0, in a cube of about 16 mm about the origin.
inline Volume bone_below_zero(double spacing_mm, double side_mm = 16) {
  const auto voxels = static_cast<int>(side_mm / spacing_mm);
  return shape_volume(centred_cube(voxels, spacing_mm), plane(Vec3::Zero(), Vec3::UnitZ()));
}

inline Region region_of(std::vector<Shape> shapes) {
  return {std::move(shapes), 7};
}

/// Returns an exercise without structures, items or steps.
inline Exercise exercise_with_target(Region target) {
  Exercise exercise;
  exercise.file = "task.toml";
  exercise.title = "Task";
  exercise.scan = "scan.nrrd";
  exercise.target = std::move(target);
  return exercise;
}

/// Mills a bone along poses, 1 ms each, and returns the recording.
inline Recording record_poses(const Volume& bone, const std::vector<Vec3>& burr_W, double burr_radius_mm) {
  SessionSettings settings;
  settings.setup.tool.burr_radius_mm = burr_radius_mm;
  settings.setup.tool.shaft_radius_mm = 0.5 * burr_radius_mm;
  settings.setup.guard = GuardSettings::for_simulation();
  settings.densities = estimate_densities(bone);
  MillingSession session(std::make_shared<Volume>(bone), settings.densities, settings.setup);
  Recording recording;
  recording.path = "attempt.h5";
  recording.description = describe_run(bone, {"scan", fingerprint_of(bone.grid())}, settings,
                                       session.algorithm().sample_point_count());
  recording.sessions.push_back({0, {.run = recording.description}});
  std::vector<TrajectoryPoint> trajectory;
  for (const Vec3& place_W : burr_W)
    trajectory.push_back({1e-3 * static_cast<double>(trajectory.size()), {place_W, Quat::Identity()}, true});
  replay(session, trajectory, [&](const TickRecord& record) { recording.records.push_back(record); });
  return recording;
}

/// Returns points on the line between two points, `step_mm` apart.
inline std::vector<Vec3> way(const Vec3& from, const Vec3& to, double step_mm) {
  const auto steps = static_cast<int>(std::ceil((to - from).norm() / step_mm));
  std::vector<Vec3> places;
  for (int n = 0; n <= steps; ++n) places.push_back(from + static_cast<double>(n) / steps * (to - from));
  return places;
}

}  // namespace osteomill::testing_support
