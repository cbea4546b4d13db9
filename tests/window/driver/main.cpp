// Test driver of the window: osteomill with the additional option --script FILE, which operates the window of
// `simulate` from that file (ui_script.h).
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"

#include "app/commands.h"
#include "tests/window/driver/ui_script.h"

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  std::optional<osteomill::app::UiScript> script;
  const auto option = std::find_if(arguments.begin(), arguments.end(),
                                   [](const char* word) { return std::string_view(word) == "--script"; });
  if (option != arguments.end() && option + 1 != arguments.end()) {
    try {
      script.emplace(*(option + 1));
    } catch (const osteomill::InputError& error) {
      fmt::print(stderr, "osteomill: {}\n", error.what());
      return 1;
    }
    arguments.erase(option, option + 2);
  }
  const int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  return osteomill::app::run_osteomill(count, arguments.data(), script ? &*script : nullptr);
}
