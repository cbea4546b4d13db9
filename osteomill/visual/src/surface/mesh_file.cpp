#include "osteomill/visual/mesh_file.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <ostream>
#include <string>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

template <typename Value>
void write_bytes(std::ostream& out, const Value& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

using Point = std::array<float, 3>;

// Returns zero for a degenerate triangle.
Point facet_normal(const std::array<Point, 3>& corners) {
  const Vec3 first = vec3_of(corners[0]);
  Point normal;
  put((vec3_of(corners[1]) - first).cross(vec3_of(corners[2]) - first).normalized(), normal);
  return normal;
}

void write_stl(std::ostream& out, const BrickMesh& mesh) {
  out << fmt::format("{:80}", "osteomill isosurface, mm, SPACE=LPS");
  write_bytes(out, static_cast<std::uint32_t>(mesh.triangle_count()));
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    std::array<Point, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = mesh.vertices[mesh.indices[n + c]].position_mm;
    write_bytes(out, facet_normal(corners));
    write_bytes(out, corners);
    write_bytes(out, std::uint16_t{0});
  }
}

// Used for vertices without a label.
const Label kUnlabelled{0, "", {222, 194, 148}, false};

const Label& label_of(const LabelMap& labels, const MeshVertex& vertex) {
  const LabelMap::LabelIndex place =
      labels.under_surface(vec3_of(vertex.position_mm), vec3_of(vertex.normal));
  return place == 0 ? kUnlabelled : labels.label(place);
}

void write_ply(std::ostream& out, const BrickMesh& mesh, const LabelMap* labels) {
  out << fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment osteomill isosurface, mm, SPACE=LPS\n"
      "element vertex {}\n",
      mesh.vertices.size());
  for (const char* property : {"x", "y", "z", "nx", "ny", "nz", "density"})
    out << "property float " << property << '\n';
  if (labels != nullptr)
    out << "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\n";
  out << fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                     mesh.triangle_count());
  for (const MeshVertex& vertex : mesh.vertices) {
    write_bytes(out, vertex);
    if (labels == nullptr) continue;
    const Label& label = label_of(*labels, vertex);
    write_bytes(out, label.colour);
    write_bytes(out, static_cast<std::int32_t>(label.value));
  }
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    write_bytes(out, std::uint8_t{3});
    for (std::size_t c = 0; c < 3; ++c) write_bytes(out, mesh.indices[n + c]);
  }
}

void write_obj(std::ostream& out, const BrickMesh& mesh, const LabelMap* labels) {
  out << "# osteomill isosurface, mm, SPACE=LPS\n";
  for (const MeshVertex& vertex : mesh.vertices) {
    out << fmt::format("v {}", fmt::join(vertex.position_mm, " "));
    if (labels != nullptr) {
      const auto& [red, green, blue] = label_of(*labels, vertex).colour;
      out << fmt::format(" {} {} {}", red / 255.0f, green / 255.0f, blue / 255.0f);
    }
    out << '\n';
  }
  for (const MeshVertex& vertex : mesh.vertices) out << fmt::format("vn {}\n", fmt::join(vertex.normal, " "));
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    out << fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", mesh.indices[n] + 1, mesh.indices[n + 1] + 1,
                       mesh.indices[n + 2] + 1);
  }
}

}  // namespace

MeshFormat mesh_format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  throw InputError(path.string(), "a mesh is written as .stl, .ply or .obj");
}

bool has_vertex_colours(MeshFormat format) {
  return format != MeshFormat::stl;
}

void write_mesh(const std::filesystem::path& path, const BrickMesh& mesh, const LabelMap* labels) {
  const MeshFormat format = mesh_format_of(path);
  write_text_atomically(path, [&](std::ostream& out) {
    switch (format) {
      case MeshFormat::stl:
        return write_stl(out, mesh);
      case MeshFormat::ply:
        return write_ply(out, mesh, labels);
      case MeshFormat::obj:
        return write_obj(out, mesh, labels);
    }
  });
}

}  // namespace osteomill
