#include "app/command_line.h"

namespace osteomill::app {

namespace {

std::string quoted(const std::string& word) {
  const bool plain = word.find_first_not_of(
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                         "_-+=./,:@%") == std::string::npos;
  if (plain && !word.empty()) return word;
  std::string text = "'";
  for (const char letter : word) {
    text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  }
  return text + "'";
}

}  // namespace

std::string command_line_of(int argc, const char* const* argv) {
  std::string line = "osteomill";
  for (int n = 1; n < argc; ++n) line += " " + quoted(argv[n]);
  return line;
}

}  // namespace osteomill::app
