#include "app/memory_limit.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"

namespace osteomill::app {

namespace {

thread_local std::string limited_scan;
thread_local std::uint64_t limit_bytes = std::numeric_limits<std::uint64_t>::max();

// Of a file of /proc: what stands behind these words, all in kB.
std::uint64_t bytes_in(const char* path, std::initializer_list<std::string_view> words) {
  std::ifstream file(path);
  std::uint64_t bytes = 0;
  for (std::string word; file >> word;) {
    std::uint64_t kB = 0;
    if (std::find(words.begin(), words.end(), word) != words.end() && file >> kB) bytes += 1024 * kB;
  }
  return bytes;
}

double gigabytes(std::uint64_t bytes) {
  return 1e-9 * static_cast<double>(bytes);
}

}  // namespace

void limit_memory(const std::string& scan, std::uint64_t bytes) {
  limited_scan = scan;
  limit_bytes = bytes;
}

void check_memory_taken() {
  constexpr std::chrono::milliseconds kEvery{100};
  thread_local std::chrono::steady_clock::time_point next;
  const auto now = std::chrono::steady_clock::now();
  if (limited_scan.empty() || now < next) return;
  // A page that two copies of the bone share counts once; the program's own files do not.
  const std::uint64_t taken = bytes_in("/proc/self/smaps_rollup", {"Pss_Anon:", "Pss_Shmem:"});
  next = std::chrono::steady_clock::now() + kEvery;
  if (taken <= limit_bytes) return;
  throw InputError(
      limited_scan,
      fmt::format("takes {:.3g} GB with what is made of it so far, over the {:.3g} GB that it may take",
                  gigabytes(taken), gigabytes(limit_bytes)));
}

std::string out_of_memory_text() {
  const std::string reason = fmt::format("not enough memory: {:.3g} GB were taken when more was asked for",
                                         gigabytes(bytes_in("/proc/self/status", {"VmHWM:"})));
  return limited_scan.empty() ? reason : limited_scan + ": " + reason;
}

}  // namespace osteomill::app
