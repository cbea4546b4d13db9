#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

namespace osteomill::testing_support {

/// Returns the private memory of this process, MiB; 0 if the system does not report it.
inline double own_memory_MiB() {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;) {
    double kiB = 0;
    if (word == "RssAnon:" && in >> kiB) return kiB / 1024;
  }
  return 0;
}

/// Returns the size of the private pages in the mapping of this address, MiB; for a private file mapping,
/// these are the pages written since. -1 if the system does not report it.
inline double copied_MiB(const void* address) {
  std::ifstream in("/proc/self/smaps");
  const auto place = reinterpret_cast<std::uintptr_t>(address);
  bool here = false;
  for (std::string line; std::getline(in, line);) {
    std::uintptr_t first = 0, end = 0;
    double kiB = 0;
    if (std::sscanf(line.c_str(), "%zx-%zx ", &first, &end) == 2) here = first <= place && place < end;
    if (here && std::sscanf(line.c_str(), "Anonymous: %lf kB", &kiB) == 1) return kiB / 1024;
  }
  return -1;
}

}  // namespace osteomill::testing_support
