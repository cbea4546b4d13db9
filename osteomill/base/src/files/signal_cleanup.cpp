#include "osteomill/base/signal_cleanup.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <string_view>
#include <system_error>

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::array kSignals{SIGTERM, SIGINT, SIGHUP};
std::array<struct sigaction, kSignals.size()> actions_before;
std::atomic<void (*)()> before_cleanup{nullptr};

// A path taken out of a slot belongs to the thread that took it. Files that find no free slot are not
// removed.
std::array<std::atomic<char*>, 64> registered_paths{};

// Removes a file or folder with async-signal-safe calls. Retries, because other threads may still add files.
void remove_recursively(int in, const char* name) {
  constexpr int kTries = 100;
  if (::unlinkat(in, name, 0) == 0) return;
  const int folder = ::openat(in, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return;
  for (int n = 0; n < kTries && ::unlinkat(in, name, AT_REMOVEDIR) != 0; ++n) {
    ::lseek(folder, 0, SEEK_SET);
    alignas(dirent64) char entries[2048];
    for (ssize_t end = 0; (end = ::getdents64(folder, entries, sizeof(entries))) > 0;) {
      for (ssize_t at = 0; at < end;) {
        const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
        at += entry->d_reclen;
        if (std::strcmp(entry->d_name, ".") != 0 && std::strcmp(entry->d_name, "..") != 0)
          remove_recursively(folder, entry->d_name);
      }
    }
  }
  ::close(folder);
}

void end_program(int signal) {
  if (void (*const action)() = before_cleanup.load()) action();
  for (std::atomic<char*>& registered : registered_paths)
    if (const char* path = registered.exchange(nullptr)) remove_recursively(AT_FDCWD, path);
  for (std::size_t n = 0; n < kSignals.size(); ++n)
    if (kSignals[n] == signal) sigaction(signal, &actions_before[n], nullptr);
  raise(signal);
}

}  // namespace

SignalCleanup::SignalCleanup(const fs::path& path) : slot_(-1) {
  std::error_code error;
  char* const text = ::strdup(fs::absolute(path, error).c_str());
  for (std::size_t n = 0; n < registered_paths.size(); ++n) {
    char* none = nullptr;
    if (!registered_paths[n].compare_exchange_strong(none, text)) continue;
    slot_ = static_cast<int>(n);
    return;
  }
  ::free(text);
}

SignalCleanup::~SignalCleanup() {
  if (slot_ >= 0) ::free(registered_paths[static_cast<std::size_t>(slot_)].exchange(nullptr));
}

void install_signal_cleanup() {
  struct sigaction action {};
  action.sa_handler = end_program;
  sigfillset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (std::size_t n = 0; n < kSignals.size(); ++n) {
    struct sigaction now {};
    sigaction(kSignals[n], nullptr, &now);
    if (now.sa_handler == end_program) continue;
    actions_before[n] = now;
    if (now.sa_handler != SIG_IGN) sigaction(kSignals[n], &action, nullptr);
  }
}

void set_before_signal_cleanup(void (*action)()) {
  before_cleanup.store(action);
}

}  // namespace osteomill
