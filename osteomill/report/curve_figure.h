#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "osteomill/report/figure.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

/// A column of panels, one a phase (milling on top), with a curve over time for each algorithm.
struct CurveColumn {
  /// Of its data files.
  std::string name;
  /// Of the y axis, with its unit.
  std::string label;
  std::function<double(const TickRecord&)> value;
  /// gnuplot commands for its panels alone (scale, range, lines).
  std::string setup;
  /// What its dashed line stands for, said above its panels; empty for none.
  std::string dashed;
};

/// Draws the columns side by side, the algorithms' names above them all. Curves are thinned out to the least
/// and greatest of each pixel's worth, and the restless ones are drawn first so that they hide no other.
Figure draw_curves(const RunGroup& group, const std::string& name, const std::vector<CurveColumn>& columns,
                   const std::filesystem::path& folder);

/// The paper's figures 6 (haptic rate and compute time), 7 (force magnitude) and 8 (torque magnitude).
Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Bone removed since the start, and the burr's centre along each axis of W.
Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder);

}  // namespace osteomill
