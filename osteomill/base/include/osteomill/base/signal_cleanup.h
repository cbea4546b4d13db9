#pragma once

#include <filesystem>

namespace osteomill {

/// Registers a file or folder for removal, with its content, if a signal ends the program while this object
/// exists (install_signal_cleanup()). The destructor does not remove it. Used by TemporaryFolder.
class SignalCleanup {
 public:
  explicit SignalCleanup(const std::filesystem::path& path);
  ~SignalCleanup();
  SignalCleanup(const SignalCleanup&) = delete;
  SignalCleanup& operator=(const SignalCleanup&) = delete;

 private:
  int slot_;
};

/// Makes SIGTERM, SIGINT and SIGHUP remove every SignalCleanup's path before their previous action; an
/// ignored signal stays ignored. Call at program start, before or after creating a CrashStop: devices are
/// released first either way.
void install_signal_cleanup();

/// Sets a function that these signals call before they remove anything; null for none. It must be
/// async-signal-safe. Used by CrashStop.
void set_before_signal_cleanup(void (*action)());

}  // namespace osteomill
