#include <cstdlib>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/study/study_report.h"

#include "app/option_checks.h"
#include "app/study_file.h"
#include "fuzz/targets.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;

namespace {

void read_study_file_of(Bytes bytes, const fs::path& folder) {
  write_bytes(folder / "s.toml", bytes);
  const StudyDesign design = app::read_study_file((folder / "s.toml").string(),
                                                  {"scan", "seed", "push", "algorithm", "burr-radius"});
  list_head(design);
  for (const std::size_t number : {std::size_t{0}, design.trial_count() / 2, design.trial_count() - 1})
    list_row(design, number);
}

std::vector<std::string> study_file_seeds(const fs::path&) {
  return {
      "title = 'a'\n[fixed]\nscan = 'x'\n[grid]\nalgorithm = ['line-proxy', 'point-shell']\n"
      "push = { from = 0.5, to = 2, steps = 4, log = true }\n[[map]]\nx = 'push'\ny = 'seed'\n"
      "colour = 'force_mean_N / push'\n",
      "test = 'wall'\n[latin-hypercube]\ntrials = 8\nseed = 3\npush = { from = 1, to = 2 }\n"
      "algorithm = ['line-proxy']\n[[list]]\nburr-radius = 1\n'point-shell.scale' = 2\n"};
}

// Returns a half-space of bone in few voxels.
Volume small_bone() {
  GridGeometry geometry;
  geometry.dims = {16, 16, 16};
  std::vector<float> densities(16 * 16 * 16, 0);
  std::fill_n(densities.begin(), densities.size() / 2, 1000.0F);
  return Volume(DensityGrid(geometry, densities), 500);
}

// Drives every algorithm along the poses of a file; all wrenches must be finite.
void replay_poses_of(Bytes bytes, const fs::path& folder) {
  constexpr std::size_t kMostTicks = 50;
  static const Volume bone = small_bone();
  write_bytes(folder / "p.csv", bytes);
  std::vector<TrajectoryPoint> poses = read_trajectory(folder / "p.csv");
  if (poses.size() > kMostTicks) poses.resize(kMostTicks);
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    MillingSetup setup;
    // With a long shaft, point-shell takes seconds to prepare under the sanitizers.
    setup.tool = {.burr_radius_mm = 1, .shaft_radius_mm = 0.7, .shaft_length_mm = 4};
    setup.algorithm = algorithm;
    MillingSession session(std::make_shared<Volume>(bone), {0, 1000}, setup);
    replay(session, poses, [](const TickRecord& tick) {
      if (!is_finite(tick.X_WT) || !tick.wrench.force_N.allFinite() || !tick.wrench.torque_Nmm.allFinite())
        std::abort();
    });
  }
}

std::vector<std::string> pose_seeds(const fs::path&) {
  return {
      "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,8,8,20,1,0,0,0,1\n0.001,8,8,8,1,0,0,0,1\n"
      "0.002,8,8,7.5,0,1,0,0,1\n0.003,2e5,-2e5,0,0.6,0,0.8,0,1\n"};
}

}  // namespace

std::vector<Target> study_file_targets() {
  return {{"study-file", read_study_file_of, study_file_seeds}, {"poses", replay_poses_of, pose_seeds}};
}

}  // namespace osteomill::fuzzing
