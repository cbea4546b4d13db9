#pragma once

#include <filesystem>
#include <string>

namespace osteomill {

/// A folder of its own that is gone, with all in it, when this object goes.
class TemporaryFolder {
 public:
  /// Throws InputError where none can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Runs `script` in a child process of `program` whose working folder is `folder`. Throws InputError where
/// gnuplot is not installed, or, with its own last word, where it fails.
void run_gnuplot(const std::filesystem::path& folder, const std::string& script,
                 const std::string& program = "gnuplot");

/// `text` between quotes that gnuplot takes as they are, without line breaks and other control characters.
std::string gnuplot_quoted(const std::string& text);

}  // namespace osteomill
