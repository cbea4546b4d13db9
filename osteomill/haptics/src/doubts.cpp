#include "doubts.h"

#include <sstream>

namespace osteomill {

void doubt_stiffness(std::vector<std::string>& doubts, const std::string& setting, double N_per_mm) {
  constexpr double kSoftest_N_per_mm = 0.05, kStiffest_N_per_mm = 200;
  std::ostringstream line;
  line << setting << " of " << N_per_mm << " N/mm is ";
  if (N_per_mm < kSoftest_N_per_mm) {
    line << "so soft that a newton takes " << 1 / N_per_mm << " mm; from " << kSoftest_N_per_mm
         << " on a hand is held";
    doubts.push_back(line.str());
  }
  if (N_per_mm > kStiffest_N_per_mm) {
    line << "so stiff that no hand can be held still; up to " << kStiffest_N_per_mm << " a device may";
    doubts.push_back(line.str());
  }
}

void doubt_reads(std::vector<std::string>& doubts, const std::string& settings, int reads) {
  constexpr int kMost = 25000;
  if (reads <= kMost) return;
  std::ostringstream line;
  line << settings << " may read " << reads << " densities in a tick; from about " << kMost
       << " on it takes over a millisecond";
  doubts.push_back(line.str());
}

}  // namespace osteomill
