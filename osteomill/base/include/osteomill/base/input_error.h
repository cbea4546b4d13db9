#pragma once

#include <cerrno>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace osteomill {

/// Returns the text with a question mark for every control character, a line's end among them: a file's own
/// words may hold anything.
inline std::string in_one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return line;
}

/// Reports that something the user handed in is at fault: a file, a folder, a row of it, or an option's
/// value. The command line prints `what()` as its one line and exits with code 1. Never thrown inside a
/// haptic tick.
class InputError : public std::runtime_error {
 public:
  /// Makes the message "SUBJECT: REASON". `subject` names the file (or option), `reason` says what is wrong
  /// with it, without a full stop. `what()` is one line whatever they hold.
  InputError(std::string_view subject, std::string_view reason)
      : std::runtime_error(in_one_line(std::string(subject) + ": " + std::string(reason))) {}
};

/// Returns `what` with the system's reason for a failed call behind it ("cannot be written: No space left on
/// device"); `what` alone if `error` (errno) is 0.
inline std::string with_reason(const std::string& what, int error = errno) {
  return error == 0 ? what : what + ": " + std::generic_category().message(error);
}

/// Returns what an exception says, in one line. `failure` is not null.
inline std::string reason_of(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    return in_one_line(error.what());
  } catch (...) {
    return "an exception without words";
  }
}

}  // namespace osteomill
