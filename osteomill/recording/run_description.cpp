#include "osteomill/recording/run_description.h"

namespace osteomill {

std::string_view name_of(RunPhase phase) {
  return phase == RunPhase::milling ? "milling" : "holding";
}

std::optional<RunPhase> phase_named(std::string_view name) {
  for (const RunPhase phase : kAllPhases) {
    if (name == name_of(phase)) return phase;
  }
  return std::nullopt;
}

}  // namespace osteomill
