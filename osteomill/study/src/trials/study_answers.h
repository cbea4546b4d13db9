#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/probe.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Returns the algorithms' labels as a list in a sentence: "1 line-proxy and 3 point-shell".
std::string labels_in_words(const std::vector<AlgorithmId>& algorithms);

/// Returns a sentence on what was compared: which algorithms, on which bone (omitted if empty), in how many
/// hands.
std::string comparison_sentence(const Study& study, std::string_view bone);

/// Explains how to read the first table of `conclusions`.
std::string table_explanation(const Study& study);

/// Returns a warning for the top of the page that a study has too few hands to show anything; empty if it has
/// enough.
std::string sample_size_warning(const Study& study);

/// Returns the tables with the main results of a comparison: a row for each algorithm with the figures to
/// choose by, each with its rank if the hands settle it; and how many of the paper's findings hold. `probes`
/// has the probed algorithms, by name.
std::vector<Table> conclusions(const Study& study, const std::map<std::string, Probe>& probes = {});

/// Returns which algorithm is best in each figure, with the runner-up, p and the number of hands, by the
/// ranks that the hands settle among the algorithms that completed the test in most hands; which of the
/// others had lower values; and what the hands do not settle. Empty if there are too few hands or only one
/// algorithm.
std::string recommendation_text(const Study& study);

}  // namespace osteomill
