#include "app/simulate/autosave.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <iterator>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <unistd.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/recording/recorder.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

using namespace std::chrono_literals;

constexpr auto kInterval = 5s;
constexpr int kWritingShare = 50;
// 1 GiB.
constexpr std::size_t kMaxBricks = (std::size_t{1} << 30) / sizeof(DensityBlock);

fs::path autosave_folder() {
  const fs::path state = state_folder();
  return state.empty() ? fs::path() : state / "autosave";
}

// Returns the folders newest first: their names begin with the time.
std::vector<fs::path> folders_in(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) folders.push_back(entry.path());
  std::sort(folders.rbegin(), folders.rend());
  return folders;
}

std::string absolute_path(const fs::path& path) {
  return path.empty() ? std::string() : fs::absolute(path).lexically_normal().string();
}

// Uses absolute paths, because the next start may be in another folder.
RunDescription describe(ScanOptions scan, const LiveMilling& milling) {
  const std::string name = is_builtin(scan.scan) ? scan.scan : absolute_path(scan.scan);
  RunDescription run = milling.describe(name.empty() ? kBuiltinTooth : name, "");
  scan.labels.map = absolute_path(scan.labels.map);
  scan.labels.table = absolute_path(scan.labels.table);
  std::ranges::move(scan_settings(scan), std::back_inserter(run.settings));
  return run;
}

}  // namespace

std::optional<AutosaveFile> AutosaveFile::try_lock(const fs::path& folder) {
  auto lock = FileLock::try_lock(folder);
  if (!lock) return std::nullopt;
  return AutosaveFile(folder, *std::move(lock));
}

std::optional<AutosaveFile> AutosaveFile::make() {
  const fs::path all = autosave_folder();
  std::error_code error;
  fs::create_directories(all, error);
  if (all.empty() || error) return std::nullopt;
  // Another process starting now may mistake the still empty folder for a leftover.
  for (int n = 0; n < 100; ++n) {
    std::string folder = all / fmt::format("{:%Y%m%d-%H%M%S}-XXXXXX", fmt::localtime(std::time(nullptr)));
    if (::mkdtemp(folder.data()) == nullptr) break;
    if (auto file = try_lock(folder)) return file;
  }
  return std::nullopt;
}

std::optional<LeftoverMilling> last_leftover_milling() {
  for (const fs::path& folder : folders_in(autosave_folder())) {
    auto file = AutosaveFile::try_lock(folder);
    if (!file) continue;
    std::error_code ignored;
    if (!fs::exists(file->path(), ignored)) {
      // Its process was killed before the first write; destroying `file` removes the folder.
      file->clear();
      continue;
    }
    try {
      SessionStart start = read_start(file->path());
      return LeftoverMilling{std::move(*file), std::move(start)};
    } catch (const InputError&) {
      // Keep it: another version of the program may be able to read it.
    }
  }
  return std::nullopt;
}

AutosaveFile::AutosaveFile(fs::path folder, FileLock lock)
    : folder_(std::move(folder)), lock_(new FileLock(std::move(lock)), [folder = folder_](FileLock* held) {
        ::rmdir(folder.c_str());
        delete held;
      }) {}

void AutosaveFile::clear() const {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) fs::remove(entry.path(), ignored);
}

Autosave::Autosave(ScanOptions scan, std::optional<AutosaveFile> file)
    : scan_(std::move(scan)), file_(std::move(file)), kept_(file_.has_value()) {}

void Autosave::take_result() {
  try {
    const Clock::duration took = work_.get();
    next_ = Clock::now() + std::max<Clock::duration>(kInterval, kWritingShare * took);
  } catch (const std::exception& error) {
    next_ = Clock::now() + 60s;
    autosaved_version_ = 0;
    error_ = std::string("Milling cannot be autosaved: ") + error.what();
  }
}

void Autosave::update(LiveMilling& milling) {
  if (work_.valid() && work_.wait_for(0s) == std::future_status::ready) take_result();
  if (work_.valid()) return;
  if (!has_unsaved(milling)) {
    if (std::exchange(kept_, false)) {
      file_->clear();
      next_ = {};
    }
    return;
  }
  const std::uint64_t version = milling.follower().version();
  if (version == autosaved_version_ || Clock::now() < next_) return;
  if (!file_) file_ = AutosaveFile::make();
  if (!file_) {
    next_ = Clock::time_point::max();
    error_ =
        "Milling cannot be autosaved because its folder cannot be written: " + autosave_folder().string();
    return;
  }
  autosaved_version_ = version;
  kept_ = true;
  SessionStart milled{.run = describe(scan_, milling), .removed_mm3 = milling.state().record.removed_mm3};
  work_ =
      std::async(std::launch::async, [&milling, path = file_->path(), milled = std::move(milled)]() mutable {
        const Clock::time_point start = Clock::now();
        milled.bricks = milling.follower().touched_bricks();
        milled.piece_drops = milling.follower().piece_drops();
        if (milled.bricks.size() > kMaxBricks) throw InputError(path.string(), "would take more than 1 GiB");
        write_start(path, milled);
        return Clock::now() - start;
      });
}

void Autosave::discard() {
  if (work_.valid()) work_.wait();
  if (file_) file_->clear();
  kept_ = false;
}

}  // namespace osteomill::app
