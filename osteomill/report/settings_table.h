#pragma once

#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/report/html.h"

namespace osteomill {

/// Every setting of the recordings, once where it is the same in all, else with the value of each algorithm
/// or, where that does not tell them apart, of each recording. The command line is left out.
HtmlTable settings_table(const std::vector<const Recording*>& recordings);

}  // namespace osteomill
