#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/report/figure.h"
#include "osteomill/report/html.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

/// What each run removed of each label, when and with what force, no-go labels first; nothing where no
/// recording has labels.
std::optional<PageSection> label_section(const RunGroup& group);

/// How much was removed of each label over time, a panel for each run that removed any, in the labels'
/// colours; nothing where none did. Throws InputError as `draw_figure` does.
std::optional<Figure> draw_label_figure(const RunGroup& group, const std::filesystem::path& folder);

}  // namespace osteomill
