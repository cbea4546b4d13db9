#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/page.h"
#include "osteomill/study/run_groups.h"

/// What a report's page is put together from. Each figure throws InputError as `draw_figure` does.
namespace osteomill {

/// The bone before, and after each algorithm, side by side, from the recordings' pictures; those of the
/// milling phase where there are any. Nothing where no recording has a picture. Throws InputError, naming the
/// recording, where a picture is not a whole PNG of sensible size.
std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder);

/// The paper's figures 6 (of whose rate it draws the compute time), 7 (force magnitude) and 8 (torque
/// magnitude), a panel for each phase and algorithm. Time is 0 where the tables begin to count
/// (counted_from_s); what was before is shaded.
Figure draw_rate_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_force_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_torque_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Bone removed since the start, in the phases in which some was, and the burr's centre along each axis of
/// W.
Figure draw_removed_figure(const RunGroup& group, const std::filesystem::path& folder);
Figure draw_path_figure(const RunGroup& group, const std::filesystem::path& folder);

/// The paper's figure 9: where the simulated tool's shaft points while it touches, in degrees across its mean
/// direction, coloured by time; a panel for each phase and algorithm, each with a scale of its own.
Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder);

/// What each run removed of each label, when and with what force, no-go labels first; nothing where no
/// recording has labels.
std::optional<Section> label_section(const RunGroup& group);

/// How much was removed of each label over time, a panel for each run that removed any, in the labels'
/// colours; nothing where none did.
std::optional<Figure> draw_label_figure(const RunGroup& group, const std::filesystem::path& folder);

/// Every setting of the recordings, once where it is the same in all, else with the value of each algorithm
/// or, where that does not tell them apart, of each recording. The command line is left out.
Table settings_table(const std::vector<const Recording*>& recordings);

/// Returns what keeps recordings from being of the same bone, tool, hand and settings: a row for each
/// recording and a column for each setting that is not the same in all; an algorithm's own settings are only
/// compared between recordings of that algorithm. No rows where they belong together.
Table differences_table(const std::vector<const Recording*>& recordings);

}  // namespace osteomill
