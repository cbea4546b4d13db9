#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/page.h"
#include "osteomill/study/run_groups.h"

/// The figures, tables and sections of a report's page. Each figure throws InputError as `draw_figure` does.
namespace osteomill {

/// Returns "4 barrier-shell, milling".
std::string run_name(const MeasuredRun& run);

/// Draws the bone before, and after each algorithm, side by side, from the recordings' pictures; those of the
/// milling phase if there are any. Returns nothing if no recording has a picture. Throws InputError, naming
/// the recording, if a picture is not a whole PNG of sensible size.
std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Draw the paper's figures 6 (as compute time, not as rate), 7 (force magnitude) and 8 (torque magnitude), a
/// panel for each phase and algorithm. Time is 0 when the tables begin to count (counted_from_s); the time
/// before is shaded.
Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Draw the bone removed since the start, in the phases in which some was, and the burr's centre along each
/// axis of W.
Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Draws the paper's figure 9: the direction of the simulated tool's shaft while it touches, in degrees
/// across its mean direction, coloured by time; a panel for each phase and algorithm, each with a scale of
/// its own.
Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Returns a section on what each run removed of each label, when and with what force, no-go labels first;
/// nothing if no recording has labels.
std::optional<Section> label_section(const RunGroup& group);

/// Draws how much was removed of each label over time, a panel for each run that removed any, in the labels'
/// colours; returns nothing if none did.
std::optional<Figure> draw_label_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Returns every setting of the recordings, once if it is the same in all, else with the value of each
/// algorithm or, if that does not tell them apart, of each recording. The command line is left out.
Table settings_table(const std::vector<const Recording*>& recordings);

/// Returns what keeps recordings from being of the same bone, tool, hand and settings: a row for each
/// recording and a column for each setting that is not the same in all; an algorithm's own settings are only
/// compared between recordings of that algorithm. There are no rows if they belong together.
Table differences_table(const std::vector<const Recording*>& recordings);

}  // namespace osteomill
