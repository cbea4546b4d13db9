#include "osteomill/haptics/mode.h"

namespace osteomill {

std::string_view name_of(Mode mode) {
  return mode == Mode::paper ? "paper" : "steady";
}

std::optional<Mode> mode_named(std::string_view name) {
  for (const Mode mode : {Mode::paper, Mode::steady}) {
    if (name == name_of(mode)) return mode;
  }
  return std::nullopt;
}

}  // namespace osteomill
