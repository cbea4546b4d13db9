#include "osteomill/haptics/algorithm_id.h"

namespace osteomill {

std::string_view name_of(AlgorithmId algorithm) {
  switch (algorithm) {
    case AlgorithmId::line_proxy:
      return "line-proxy";
    case AlgorithmId::surface_points:
      return "surface-points";
    case AlgorithmId::point_shell:
      return "point-shell";
  }
  return "";
}

std::optional<AlgorithmId> algorithm_named(std::string_view name) {
  for (const AlgorithmId algorithm : kAllAlgorithms) {
    if (name == name_of(algorithm)) return algorithm;
  }
  return std::nullopt;
}

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
