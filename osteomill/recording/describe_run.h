#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "osteomill/recording/run_description.h"
#include "osteomill/recording/session_settings.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// What any session is made of. Whoever runs it adds the settings of its own (a script, a hand) to what
/// `describe_run` makes of this.
struct RunFacts {
  std::string scan_name;
  /// Of the scan as it was read (fingerprint_of); a recording can be verified only against that one.
  std::uint64_t scan_hash = 0;
  GridGeometry geometry;
  double isovalue = 0;
  SessionSettings session;
  std::uint64_t seed = 0;
  /// How the program was called; may be empty.
  std::string command_line;
  /// Null where the bone has none.
  std::shared_ptr<const LabelMap> labels{};
};

/// All that a recording says of such a session: program, scan, tool, every setting with its unit.
/// `sample_points` is how many the algorithm works with as it stands.
RunDescription describe_run(const RunFacts& facts, int sample_points);

}  // namespace osteomill
