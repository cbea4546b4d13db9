#include "osteomill/base/run_program.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>

#include <sys/wait.h>

#include "osteomill/base/input_error.h"

namespace osteomill {

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

ProcessResult run_program(const std::vector<std::string>& words, std::chrono::duration<double> limit) {
  constexpr std::size_t kMaxKeptBytes = 16'000'000;
  // Kills child processes too; otherwise fread would wait for them.
  std::ostringstream seconds;
  seconds << limit.count();
  std::string line = "timeout --signal=KILL " + seconds.str() + " ";
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& word : words) line += quoted(word) + " ";
  std::FILE* output = ::popen((line + "2>&1 </dev/null").c_str(), "r");
  if (output == nullptr) throw InputError(words.front(), "cannot be started");
  ProcessResult result;
  std::array<char, 4096> part{};
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), output))
    result.text.append(part.data(), std::min(count, kMaxKeptBytes - result.text.size()));
  const int status = ::pclose(output);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (result.exit_code != 0 && std::chrono::steady_clock::now() - start >= limit)
    throw InputError(words.front(), "did not end within " + seconds.str() + " s");
  return result;
}

}  // namespace osteomill
