#include "osteomill/haptics/line_proxy/centreline.h"

namespace osteomill {

std::vector<Vec3> centreline_vertices(const MillingTool& tool, int count) {
  std::vector<Vec3> vertices;
  vertices.reserve(static_cast<std::size_t>(count));
  for (int n = 0; n < count; ++n) {
    vertices.emplace_back(0.0, 0.0, tool.shaft_length_mm * n / (count - 1));
  }
  return vertices;
}

}  // namespace osteomill
