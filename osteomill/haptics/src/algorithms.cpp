#include "osteomill/haptics/algorithms.h"

#include <stdexcept>

#include "barrier_shell/barrier_shell.h"
#include "published/line_proxy/line_proxy.h"
#include "published/point_shell/point_shell.h"
#include "published/surface_points/surface_points.h"

namespace osteomill {

const std::vector<AlgorithmDescription>& all_algorithms() {
  static const std::vector<AlgorithmDescription> all{
      line_proxy::description(),
      surface_points::description(),
      point_shell::description(),
      barrier_shell::description(),
  };
  return all;
}

const std::vector<std::string>& algorithm_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const AlgorithmDescription& algorithm : all_algorithms()) all.push_back(algorithm.id.name);
    return all;
  }();
  return names;
}

const AlgorithmDescription* find_algorithm(std::string_view name) {
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    if (algorithm.id.name == name) return &algorithm;
  }
  return nullptr;
}

const AlgorithmDescription& algorithm_named(std::string_view name) {
  if (const AlgorithmDescription* algorithm = find_algorithm(name)) return *algorithm;
  throw std::invalid_argument("there is no algorithm " + std::string(name));
}

const AlgorithmDescription& default_algorithm() {
  return algorithm_named("barrier-shell");
}

}  // namespace osteomill
