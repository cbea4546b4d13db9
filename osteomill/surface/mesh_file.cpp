#include "osteomill/surface/mesh_file.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>
#include <ostream>
#include <string>

#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

// Collects what is written into large pieces.
class Output {
 public:
  explicit Output(std::ostream& out) : out_(out) { buffer_.reserve(2 * kPiece); }
  ~Output() { out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size())); }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  template <typename Value>
  void bytes(const Value& value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    text({raw, sizeof value});
  }
  void text(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() < kPiece) return;
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  // The shortest that reads back to the same number.
  template <typename Number>
  void number(Number value) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    text({digits, static_cast<std::size_t>(end - digits)});
  }

 private:
  static constexpr std::size_t kPiece = 1 << 20;
  std::ostream& out_;
  std::string buffer_;
};

using Point = std::array<float, 3>;

// Zero for a triangle without area.
Point facet_normal(const std::array<Point, 3>& corners) {
  const Vec3 first = vec3_of(corners[0]);
  Point normal;
  put((vec3_of(corners[1]) - first).cross(vec3_of(corners[2]) - first).normalized(), normal);
  return normal;
}

void write_stl(Output& out, const BrickMesh& mesh) {
  std::string head = "osteomill isosurface, mm, SPACE=LPS";
  head.resize(80, ' ');
  out.text(head);
  out.bytes(static_cast<std::uint32_t>(mesh.triangle_count()));
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    std::array<Point, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = mesh.vertices[mesh.indices[n + c]].position_mm;
    out.bytes(facet_normal(corners));
    out.bytes(corners);
    out.bytes(std::uint16_t{0});
  }
}

// What is under a vertex that has no label.
const Label kUnlabelled{0, "", {222, 194, 148}, false};

const Label& label_of(const LabelMap& labels, const MeshVertex& vertex) {
  const LabelMap::Place place = labels.under_surface(vec3_of(vertex.position_mm), vec3_of(vertex.normal));
  return place == 0 ? kUnlabelled : labels.label(place);
}

void write_ply(Output& out, const BrickMesh& mesh, const LabelMap* labels) {
  out.text(
      "ply\nformat binary_little_endian 1.0\ncomment osteomill isosurface, mm, SPACE=LPS\nelement vertex ");
  out.number(mesh.vertices.size());
  for (const char* property : {"x", "y", "z", "nx", "ny", "nz", "density"}) {
    out.text("\nproperty float ");
    out.text(property);
  }
  if (labels != nullptr) {
    out.text("\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label");
  }
  out.text("\nelement face ");
  out.number(mesh.triangle_count());
  out.text("\nproperty list uchar int vertex_indices\nend_header\n");
  for (const MeshVertex& vertex : mesh.vertices) {
    out.bytes(vertex);
    if (labels == nullptr) continue;
    const Label& label = label_of(*labels, vertex);
    out.bytes(label.colour);
    out.bytes(static_cast<std::int32_t>(label.value));
  }
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    out.bytes(std::uint8_t{3});
    for (std::size_t c = 0; c < 3; ++c) out.bytes(mesh.indices[n + c]);
  }
}

void write_numbers(Output& out, const Point& numbers) {
  for (const float number : numbers) {
    out.text(" ");
    out.number(number);
  }
}

void write_obj(Output& out, const BrickMesh& mesh, const LabelMap* labels) {
  out.text("# osteomill isosurface, mm, SPACE=LPS\n");
  for (const MeshVertex& vertex : mesh.vertices) {
    out.text("v");
    write_numbers(out, vertex.position_mm);
    if (labels != nullptr) {
      const auto& [red, green, blue] = label_of(*labels, vertex).colour;
      write_numbers(out, {red / 255.0f, green / 255.0f, blue / 255.0f});
    }
    out.text("\n");
  }
  for (const MeshVertex& vertex : mesh.vertices) {
    out.text("vn");
    write_numbers(out, vertex.normal);
    out.text("\n");
  }
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    out.text("f");
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t one_based = mesh.indices[n + c] + 1;
      out.text(" ");
      out.number(one_based);
      out.text("//");
      out.number(one_based);
    }
    out.text("\n");
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

bool holds_colours(MeshFormat format) {
  return format != MeshFormat::stl;
}

void write_mesh(const std::filesystem::path& path, const BrickMesh& mesh, const LabelMap* labels) {
  const MeshFormat format = mesh_format_of(path);
  write_text_atomically(path, [&](std::ostream& stream) {
    Output out(stream);
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
