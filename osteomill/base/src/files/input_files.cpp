#include "osteomill/base/input_files.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>

namespace osteomill {

namespace fs = std::filesystem;

namespace {

std::mutex mutex;
// Stored by name: the inode of a deleted file may be reused.
std::optional<std::set<fs::path>> inputs;

}  // namespace

InputProtection::InputProtection() {
  const std::lock_guard lock(mutex);
  inputs.emplace();
}

InputProtection::~InputProtection() {
  const std::lock_guard lock(mutex);
  inputs.reset();
}

void register_input(const fs::path& path) {
  const std::lock_guard lock(mutex);
  if (inputs) inputs->insert(fs::absolute(path));
}

bool is_input(const fs::path& path) {
  const std::lock_guard lock(mutex);
  std::error_code error;
  if (!inputs || !fs::exists(path, error)) return false;
  return std::any_of(inputs->begin(), inputs->end(),
                     [&](const fs::path& input) { return fs::equivalent(path, input, error); });
}

}  // namespace osteomill
