#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "osteomill/study/run_groups.h"
#include "osteomill/study/write_report.h"

namespace osteomill {

/// The bones that runs left, as a page shows them in 3D.
struct MilledBones {
  /// The page's data (bone_page.h); null if it shows none.
  nlohmann::json data;
  /// Why bones are missing.
  std::vector<std::string> notices;
};

/// Mills the bone of the first runs again and returns each as a body of its own, with the bone before; in at
/// most `max_bytes` of a page. A run that another recording began has no bone of its own. Long work.
MilledBones milled_bones(const RunGroup& group, const ScanOf& scan_of, std::size_t max_bytes);

}  // namespace osteomill
