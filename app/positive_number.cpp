#include "app/positive_number.h"

#include <charconv>

#include <fmt/core.h>

#include "osteomill/numbers/positive.h"

namespace osteomill::app {

CLI::Validator positive_number() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && is_positive(value);
        return good ? std::string() : text + " is not a positive number";
      },
      "");
}

CLI::Validator whole_number(std::uint64_t min, std::uint64_t max) {
  return CLI::Validator(
      [=](std::string& text) {
        std::uint64_t value = 0;
        const char* end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data(), end, value);
        const bool good = error == std::errc() && rest == end && value >= min && value <= max;
        return good ? std::string() : fmt::format("{} is not a whole number from {} to {}", text, min, max);
      },
      "");
}

CLI::Validator not_empty() {
  return CLI::Validator([](std::string& text) { return text.empty() ? "is empty" : std::string(); }, "");
}

}  // namespace osteomill::app
