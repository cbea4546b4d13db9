#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace osteomill::app {

/// The folders in a folder, and the files that may be opened as a scan or a recording.
struct FolderListing {
  struct Entry {
    std::string name;
    bool is_folder = false;
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  std::filesystem::path folder;
  /// Folders first, each kind by name.
  std::vector<Entry> entries;
  /// One line on why the folder cannot be read; empty if it can.
  std::string complaint;
  /// It is no folder but a file.
  bool is_file = false;
  /// True if the folder holds more than are listed.
  bool has_more = false;
};

/// The most entries that are listed; more are no help to the eye, and would take seconds to sort and check.
inline constexpr std::size_t kMaxListed = 20'000;

/// Lists a folder without hidden files. Ends early once `is_stopped` is true. May take as long as the file
/// system likes.
FolderListing list_folder(const std::filesystem::path& folder, const std::atomic<bool>& is_stopped);

/// Lists folders on a thread of its own, which is left behind if a file system does not answer. For one
/// thread.
class FolderReader {
 public:
  FolderReader() = default;
  ~FolderReader() { stop(); }
  FolderReader(const FolderReader&) = delete;
  FolderReader& operator=(const FolderReader&) = delete;

  /// Begins to list a folder; what is being listed is given up.
  void begin(const std::filesystem::path& folder);
  bool is_reading() const { return work_ != nullptr; }
  /// Returns the listing once it is there.
  std::optional<FolderListing> take();

 private:
  struct Work;
  void stop();
  std::shared_ptr<Work> work_;
};

}  // namespace osteomill::app
