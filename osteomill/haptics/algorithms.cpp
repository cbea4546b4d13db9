#include "osteomill/haptics/algorithms.h"

#include <stdexcept>

#include "osteomill/haptics/line_proxy/line_proxy_description.h"
#include "osteomill/haptics/point_shell/point_shell_description.h"
#include "osteomill/haptics/surface_points/surface_points_description.h"

namespace osteomill {

const std::vector<AlgorithmDescription>& all_algorithms() {
  static const std::vector<AlgorithmDescription> all{
      line_proxy::description(),
      surface_points::description(),
      point_shell::description(),
  };
  return all;
}

std::vector<std::string> algorithm_names() {
  std::vector<std::string> names;
  for (const AlgorithmDescription& algorithm : all_algorithms()) names.push_back(algorithm.id.name);
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

}  // namespace osteomill
