#include "osteomill/base/machine.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>

#include <sched.h>
#include <unistd.h>

namespace osteomill {

namespace {

namespace fs = std::filesystem;

// Calls `use` with the file `name` of the program's control group and of each of its ancestors.
void for_each_control_group(const fs::path& root, const char* name,
                            const std::function<void(std::ifstream&)>& use) {
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    // Only the line of cgroup v2, which has hierarchy number 0 and no controller list.
    if (!line.starts_with("0::/")) continue;
    fs::path group = fs::path(line.substr(4)).lexically_normal();
    for (;; group = group.parent_path()) {
      std::ifstream file(root / "sys/fs/cgroup" / group / name);
      use(file);
      if (group.empty()) return;
    }
  }
}

// Retries with larger sets, because a machine may have more processors than a cpu_set_t holds.
std::size_t processors_of_this_program() {
  for (std::size_t room = CPU_SETSIZE; room <= 64 * CPU_SETSIZE; room *= 2) {
    cpu_set_t* const set = CPU_ALLOC(room);
    if (set == nullptr) break;
    const std::size_t size = CPU_ALLOC_SIZE(room);
    const bool known = sched_getaffinity(0, size, set) == 0;
    const int count = known ? CPU_COUNT_S(size, set) : 0;
    CPU_FREE(set);
    if (known) return static_cast<std::size_t>(std::max(1, count));
  }
  return 1;
}

}  // namespace

std::size_t allowed_threads(const fs::path& root) {
  double threads = static_cast<double>(processors_of_this_program());
  for_each_control_group(root, "cpu.max", [&](std::ifstream& file) {
    double quota_us = 0, period_us = 0;
    // Extraction fails for "max".
    if (file >> quota_us >> period_us && period_us > 0) threads = std::min(threads, quota_us / period_us);
  });
  return static_cast<std::size_t>(std::max(1.0, std::ceil(threads)));
}

std::uint64_t allowed_memory_bytes(const fs::path& root) {
  std::uint64_t bytes = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                        static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  for_each_control_group(root, "memory.max", [&](std::ifstream& file) {
    std::uint64_t most = 0;
    if (file >> most) bytes = std::min(bytes, most);
  });
  return bytes;
}

}  // namespace osteomill
