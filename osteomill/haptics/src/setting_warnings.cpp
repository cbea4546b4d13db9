#include "setting_warnings.h"

#include <sstream>

namespace osteomill {

void add_stiffness_warning(std::vector<std::string>& warnings, const std::string& setting, double N_per_mm) {
  constexpr double kMinStiffness_N_per_mm = 0.05, kMaxStiffness_N_per_mm = 200;
  std::ostringstream line;
  line << setting << " of " << N_per_mm << " N/mm is ";
  if (N_per_mm < kMinStiffness_N_per_mm) {
    line << "too soft: 1 N takes " << 1 / N_per_mm << " mm; use " << kMinStiffness_N_per_mm << " or more";
    warnings.push_back(line.str());
  }
  if (N_per_mm > kMaxStiffness_N_per_mm) {
    line << "too stiff to hold a hand still; use " << kMaxStiffness_N_per_mm << " or less";
    warnings.push_back(line.str());
  }
}

void add_reads_warning(std::vector<std::string>& warnings, const std::string& settings, int reads) {
  constexpr int kMaxReads = 25000;
  if (reads <= kMaxReads) return;
  std::ostringstream line;
  line << settings << " may read " << reads << " densities in a tick; above about " << kMaxReads
       << " it takes over a millisecond";
  warnings.push_back(line.str());
}

}  // namespace osteomill
