#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/page.h"
#include "osteomill/study/run_groups.h"

/// Figures, tables and sections of a report's page. Each figure throws InputError as `draw_figure`.
namespace osteomill {

/// Returns the run's algorithm and phase: "4 barrier-shell, milling".
std::string run_name(const MeasuredRun& run);

/// Draws the bone before, and after each algorithm, side by side, from the recordings' pictures; those of the
/// milling phase if there are any. Returns nothing if no recording has a picture. Throws InputError, naming
/// the recording, if a picture is not a complete PNG of reasonable size.
std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Draw the paper's figures 6 (as compute time, not as rate), 7 (force magnitude) and 8 (torque magnitude),
/// with a panel for each phase and algorithm. Time 0 is the start of the counted ticks (counted_from_s); the
/// time before is shaded.
Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Draw the bone removed since the start, in the phases that removed some, and the position of the burr's
/// centre along each axis of W.
Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Draws the paper's figure 9: the direction of the simulated tool's shaft while in contact, in degrees from
/// its mean direction, coloured by time; a panel for each phase and algorithm, each with its own scale.
Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Returns a section on how much of each label a run removed, when and with what force, no-go labels first;
/// nothing if no recording has labels.
std::optional<Section> label_section(const RunGroup& group);

/// Draws the removed volume of each label over time, with a panel for each run that removed any, in the
/// labels' colours; returns nothing if no run did.
std::optional<Figure> draw_label_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Returns every setting of the recordings: once if all agree, else with the value for each algorithm or, if
/// recordings of an algorithm differ, for each recording. Omits the command line.
Table settings_table(const std::vector<const Recording*>& recordings);

/// Returns the differences in bone, tool, hand and settings: a row for each recording and a column for each
/// setting that is not the same in all. An algorithm's own settings are only compared between recordings of
/// that algorithm. There are no rows if nothing differs.
Table differences_table(const std::vector<const Recording*>& recordings);

}  // namespace osteomill
