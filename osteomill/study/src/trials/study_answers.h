#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/probe.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Returns the algorithms' labels as a sentence has them: "1 line-proxy and 3 point-shell".
std::string labels_in_words(const std::vector<AlgorithmId>& algorithms);

/// Returns a sentence on which algorithms did what, on which bone (no more of it is said if it is empty), in
/// how many hands.
std::string what_was_compared(const Study& study, std::string_view bone);

/// Returns how the first table of `conclusions` is to be read.
std::string about_the_table(const Study& study);

/// Returns a warning, to stand ahead of all else, that a study has too few hands to show anything; empty
/// if it has enough.
std::string too_few_hands(const Study& study);

/// Returns the tables that show what a comparison found, for readers of nothing else: a row for each
/// algorithm with what one chooses by, each figure with its rank if the hands settle it; and how many of the
/// paper's findings hold. `probes` has the algorithms that were probed, by their names.
std::vector<Table> conclusions(const Study& study, const std::map<std::string, Probe>& probes = {});

/// Returns which algorithm is best in what, with the next, p and the number of hands, by the ranks that the
/// hands settle among those that did all of the test in most hands; which of the others had less; and what
/// the hands do not settle. Empty if the hands are too few, or for one algorithm alone.
std::string which_to_take(const Study& study);

}  // namespace osteomill
