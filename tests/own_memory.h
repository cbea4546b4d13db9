#pragma once

#include <fstream>
#include <string>

namespace osteomill::testing_support {

/// What the system says that this process alone holds and that would go with it, in MiB; 0 where it does not
/// say.
inline double own_memory_MiB() {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;) {
    double kiB = 0;
    if (word == "RssAnon:" && in >> kiB) return kiB / 1024;
  }
  return 0;
}

}  // namespace osteomill::testing_support
