#include "app/memory_limit.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <mutex>
#include <string_view>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"

namespace osteomill::app {

namespace {

struct Limit {
  std::string scan;
  std::uint64_t bytes = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t baseline_bytes = 0;
};

std::mutex mutex;
Limit limit;

Limit limit_now() {
  const std::lock_guard lock(mutex);
  return limit;
}

// Returns the sum of the numbers after these words in a file of /proc, which are in kB.
std::uint64_t bytes_in(const char* path, std::initializer_list<std::string_view> words) {
  std::ifstream file(path);
  std::uint64_t bytes = 0;
  for (std::string word; file >> word;) {
    std::uint64_t kB = 0;
    if (std::find(words.begin(), words.end(), word) != words.end() && file >> kB) bytes += 1024 * kB;
  }
  return bytes;
}

// Counts a page shared by two copies of the bone once, and excludes the program's own files.
std::uint64_t used_memory_bytes() {
  return bytes_in("/proc/self/smaps_rollup", {"Pss_Anon:", "Pss_Shmem:"});
}

double gigabytes(std::uint64_t bytes) {
  return 1e-9 * static_cast<double>(bytes);
}

}  // namespace

void limit_memory(const std::string& scan, std::uint64_t bytes) {
  const std::lock_guard lock(mutex);
  limit = {scan, bytes, used_memory_bytes()};
}

void check_memory_limit() {
  constexpr std::chrono::milliseconds kEvery{100};
  thread_local std::chrono::steady_clock::time_point next;
  if (std::chrono::steady_clock::now() < next) return;
  const Limit allowed = limit_now();
  if (allowed.scan.empty()) return;
  next = std::chrono::steady_clock::now() + kEvery;
  // The resident size is an upper bound that the kernel keeps up to date; proportional shares cost a walk
  // over all pages.
  if (bytes_in("/proc/self/status", {"RssAnon:", "RssShmem:"}) <= allowed.baseline_bytes + allowed.bytes)
    return;
  const std::uint64_t taken = used_memory_bytes();
  if (taken <= allowed.baseline_bytes + allowed.bytes) return;
  throw InputError(
      allowed.scan,
      fmt::format("takes {:.3g} GB so far, with the data derived from it, and the limit is {:.3g} GB",
                  gigabytes(taken - allowed.baseline_bytes), gigabytes(allowed.bytes)));
}

std::string out_of_memory_text() {
  const std::string reason = fmt::format("not enough memory: the program used {:.3g} GB when it needed more",
                                         gigabytes(bytes_in("/proc/self/status", {"VmHWM:"})));
  const std::string scan = limit_now().scan;
  return scan.empty() ? reason : scan + ": " + reason;
}

}  // namespace osteomill::app
