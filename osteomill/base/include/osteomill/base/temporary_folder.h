#pragma once

#include <filesystem>
#include <optional>

#include "osteomill/base/signal_cleanup.h"

namespace osteomill {

/// A new folder, removed with its content when this object is destroyed or a signal ends the program
/// (signal_cleanup.h).
class TemporaryFolder {
 public:
  /// Throws InputError if the folder cannot be created.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
  std::optional<SignalCleanup> cleanup_;
};

}  // namespace osteomill
