#pragma once

#include <cerrno>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace osteomill {

/// Returns the text with every control character, line ends included, replaced by a question mark: text from
/// a file may contain anything.
inline std::string in_one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return line;
}

/// Reports faulty user input: a file, a folder, a row of a file, or the value of an option. The command line
/// prints `what()` as its one line and exits with code 1. Never thrown in a haptic tick.
class InputError : public std::runtime_error {
 public:
  /// Creates the message "SUBJECT: REASON". `subject` names the file or option; `reason` states the fault,
  /// without a full stop. `what()` is always a single line.
  InputError(std::string_view subject, std::string_view reason)
      : std::runtime_error(in_one_line(std::string(subject) + ": " + std::string(reason))) {}
};

/// Returns `what` followed by the system's reason for a failed call ("cannot be written: No space left on
/// device"); `what` alone if `error` (errno) is 0.
inline std::string with_reason(const std::string& what, int error = errno) {
  return error == 0 ? what : what + ": " + std::generic_category().message(error);
}

/// Returns the message of an exception in one line. `failure` must not be null.
inline std::string reason_of(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    return in_one_line(error.what());
  } catch (...) {
    return "unknown exception";
  }
}

}  // namespace osteomill
