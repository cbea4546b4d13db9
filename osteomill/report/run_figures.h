#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/report/figure.h"
#include "osteomill/report/run_groups.h"

/// The figures of one mode's runs. Each throws InputError as `draw_figure` does.
namespace osteomill {

/// The bone before, and after each algorithm, side by side, from the recordings' pictures; those of the
/// milling phase where there are any. Nothing where no recording has a picture. Throws InputError, naming the
/// recording, where a picture is not a whole PNG of sensible size.
std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder);

/// The paper's figures 6 (haptic rate and compute time), 7 (force magnitude) and 8 (torque magnitude).
Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Bone removed since the start, and the burr's centre along each axis of W.
Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder);

/// The paper's figure 9: where the simulated tool's shaft points, as points on the unit sphere coloured by
/// time, a panel for each phase and algorithm. The panels of a phase have the same ranges, all three axes the
/// same scale.
Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder);

}  // namespace osteomill
