#include "app/positive_number.h"

#include "osteomill/numbers/positive.h"

namespace osteomill::app {

CLI::Validator positive_number() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && is_positive(value);
        return good ? std::string() : text + " is not a positive number";
      },
      "POSITIVE");
}

}  // namespace osteomill::app
