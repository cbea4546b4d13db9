#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "osteomill/study/run_groups.h"
#include "osteomill/study/write_report.h"

namespace osteomill {

/// Bones that runs left, for a 3D view in a page.
struct MilledBones {
  /// Data of the page (bone_page.h); null if it shows no bones.
  nlohmann::json data;
  /// Reasons for missing bones.
  std::vector<std::string> notices;
};

/// Repeats the milling of the group's first runs, at most 8, and returns each resulting bone as a body, with
/// the bone before, in at most `max_bytes` of a page; a notice states how many were left out. Runs that
/// continue another recording have no bone of their own. Slow.
MilledBones milled_bones(const RunGroup& group, const ScanOf& scan_of, std::size_t max_bytes);

}  // namespace osteomill
