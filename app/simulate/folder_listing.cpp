#include "app/simulate/folder_listing.h"

#include <algorithm>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>

#include "osteomill/ct/read_scan.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

bool may_be_opened(const fs::path& file) {
  return file.extension() == ".h5" || file.extension() == ".toml" || may_be_scan(file);
}

}  // namespace

FolderListing list_folder(const fs::path& folder, const std::atomic<bool>& is_stopped) {
  FolderListing listing{folder, {}, "", false, false};
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end && !is_stopped;
       entry.increment(error)) {
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    const bool is_folder = entry->is_directory(ignored);
    if (name.starts_with('.') || (!is_folder && !entry->is_regular_file(ignored))) continue;
    if (!is_folder && !may_be_opened(entry->path())) continue;
    listing.has_more = listing.entries.size() == kMaxListed;
    if (listing.has_more) break;
    listing.entries.push_back({name, is_folder});
  }
  listing.is_file = error == std::errc::not_a_directory;
  if (error && !listing.is_file) listing.complaint = folder.string() + ": cannot be read: " + error.message();
  std::ranges::sort(listing.entries, [](const auto& a, const auto& b) {
    return std::tie(b.is_folder, a.name) < std::tie(a.is_folder, b.name);
  });
  return listing;
}

struct FolderReader::Work {
  std::atomic<bool> is_stopped = false;
  std::atomic<bool> is_done = false;
  FolderListing listing;
};

void FolderReader::begin(const fs::path& folder) {
  stop();
  work_ = std::make_shared<Work>();
  // Detached, because a dead mount may block the thread for minutes.
  std::thread([work = work_, folder] {
    work->listing = list_folder(folder, work->is_stopped);
    work->is_done = true;
  }).detach();
}

std::optional<FolderListing> FolderReader::take() {
  if (!work_ || !work_->is_done) return std::nullopt;
  return std::move(std::exchange(work_, nullptr)->listing);
}

void FolderReader::stop() {
  if (work_) work_->is_stopped = true;
  work_.reset();
}

}  // namespace osteomill::app
