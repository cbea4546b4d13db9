#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/report/figure.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

/// The bone before, and after each algorithm, side by side, from the recordings' pictures; those of the
/// milling phase where there are any. Nothing where no recording has a picture. Throws InputError, naming the
/// recording, where a picture is not a whole PNG of sensible size.
std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder);

}  // namespace osteomill
