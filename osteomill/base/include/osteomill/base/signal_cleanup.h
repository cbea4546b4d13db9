#pragma once

#include <filesystem>

namespace osteomill {

/// Marks a file or folder that is only meant to be there while this object lives, as that of a
/// TemporaryFolder. A program that is asked to end meanwhile (install_signal_cleanup()) removes it with
/// all that is in it; this object's end does not.
class SignalCleanup {
 public:
  explicit SignalCleanup(const std::filesystem::path& path);
  ~SignalCleanup();
  SignalCleanup(const SignalCleanup&) = delete;
  SignalCleanup& operator=(const SignalCleanup&) = delete;

 private:
  int slot_;
};

/// Lets SIGTERM, SIGINT and SIGHUP remove every SignalCleanup before they do what they did; one that is
/// ignored stays so. For a program to call as it starts, before or after it makes a CrashStop: devices are
/// let go of first either way.
void install_signal_cleanup();

/// Lets these signals call `action` before they remove anything; null for nothing. It may only do what is
/// safe in a signal's handler. CrashStop sets one.
void set_before_signal_cleanup(void (*action)());

}  // namespace osteomill
