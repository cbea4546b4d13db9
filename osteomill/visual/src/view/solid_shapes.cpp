#include "view/solid_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace osteomill {

namespace {

constexpr std::string_view kSolidVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 camera_from_shape;
uniform mat3 normal_from_shape;
uniform mat4 clip_from_camera;
out vec3 normal_C;
void main() {
  gl_Position = clip_from_camera * (camera_from_shape * vec4(position, 1.0));
  normal_C = normal_from_shape * normal;
}
)";

constexpr std::string_view kSolidFragment = R"(#version 330 core
in vec3 normal_C;
uniform vec4 base;
uniform float gloss;
out vec4 colour;
void main() {
  vec3 n = normalize(normal_C);
  vec3 towards_light = normalize(vec3(-0.45, 0.60, 0.66));
  float light = 0.50 + 0.10 * n.y + 0.50 * max(dot(n, towards_light), 0.0);
  float shine = gloss * pow(max(dot(n, normalize(towards_light + vec3(0.0, 0.0, 1.0))), 0.0), 40.0);
  colour = vec4(base.rgb * light + shine, base.a);
}
)";

constexpr int kSides = 32;
constexpr int kRings = 16;
constexpr double kHeadLength = 5.0;
constexpr double kHeadWidth = 2.4;

Mat3 axes_along(const Vec3& direction) {
  return smallest_rotation(Vec3::UnitZ(), direction).toRotationMatrix();
}

}  // namespace

// Revolves an outline about z. Its points are radius, height, and the normal's radial and axial components,
// two per segment.
SolidShapes::Shape SolidShapes::make_surface_of_revolution(const std::vector<std::array<float, 4>>& outline) {
  std::vector<float> corners;
  const auto corner = [&](const std::array<float, 4>& point, int side) {
    const double angle = 2 * std::numbers::pi * side / kSides;
    const auto c = static_cast<float>(std::cos(angle));
    const auto s = static_cast<float>(std::sin(angle));
    corners.insert(corners.end(),
                   {c * point[0], s * point[0], point[1], c * point[2], s * point[2], point[3]});
  };
  for (std::size_t n = 0; n + 1 < outline.size(); n += 2) {
    for (int side = 0; side < kSides; ++side) {
      for (const auto& [end, turn] : {std::pair{0u, 0}, {0u, 1}, {1u, 1}, {0u, 0}, {1u, 1}, {1u, 0}}) {
        corner(outline[n + end], side + turn);
      }
    }
  }
  Shape shape{gl::VertexArray::make(), gl::Buffer::make(), static_cast<GLsizei>(corners.size() / 6)};
  glBindVertexArray(shape.vertex_array.get());
  gl::fill<float>(GL_ARRAY_BUFFER, shape.vertices, corners, GL_STATIC_DRAW);
  gl::set_attribute(0, 3, 6 * sizeof(float), 0);
  gl::set_attribute(1, 3, 6 * sizeof(float), 3 * sizeof(float));
  return shape;
}

SolidShapes::SolidShapes() : program_(gl::make_program(kSolidVertex, kSolidFragment)) {
  std::vector<std::array<float, 4>> round;
  for (int ring = 0; ring < kRings; ++ring) {
    for (const int end : {ring, ring + 1}) {
      const double angle = std::numbers::pi * (static_cast<double>(end) / kRings - 0.5);
      const auto radius = static_cast<float>(std::cos(angle));
      const auto height = static_cast<float>(std::sin(angle));
      round.push_back({radius, height, radius, height});
    }
  }
  sphere_ = make_surface_of_revolution(round);
  cylinder_ = make_surface_of_revolution(
      {{0, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, 1, 0}, {1, 1, 1, 0}, {1, 1, 0, 1}, {0, 1, 0, 1}});
  cone_ =
      make_surface_of_revolution({{0, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, 0.9f, 0.43f}, {0, 1, 0.9f, 0.43f}});
}

std::string_view SolidShapes::vertex_source() {
  return kSolidVertex;
}

void SolidShapes::begin(const Projection& projection, GLuint program) const {
  glUseProgram(program);
  used_ = program;
  camera_from_world_ = projection.camera_from_world;
  glUniformMatrix4fv(glGetUniformLocation(program, "clip_from_camera"), 1, GL_FALSE,
                     projection.clip_from_camera.data());
}

void SolidShapes::sphere(const Vec3& centre_W, double radius_mm, const Colour& colour) const {
  draw(sphere_, centre_W, Mat3::Identity(), Vec3::Constant(radius_mm), colour, kGloss);
}

void SolidShapes::cylinder(const Vec3& from_W, const Vec3& to_W, double radius_mm, const Colour& colour,
                           float gloss) const {
  const Vec3 along = to_W - from_W;
  if (!(along.norm() > 0)) return;
  draw(cylinder_, from_W, axes_along(along), {radius_mm, radius_mm, along.norm()}, colour, gloss);
}

void SolidShapes::arrow(const Vec3& from_W, const Vec3& along_mm, double radius_mm, const Colour& colour,
                        int heads) const {
  const double length_mm = along_mm.norm();
  const double head_mm = kHeadLength * radius_mm;
  if (length_mm < radius_mm) return;
  const Vec3 unit = along_mm / length_mm;
  const double shaft_mm = std::max(length_mm - heads * head_mm, 0.0);
  cylinder(from_W, from_W + shaft_mm * unit, radius_mm, colour, 0);
  const double width_mm = kHeadWidth * radius_mm;
  const double each_mm = std::min(head_mm, (length_mm - shaft_mm) / heads);
  for (int n = 0; n < heads; ++n) {
    draw(cone_, from_W + (shaft_mm + n * each_mm) * unit, axes_along(unit), {width_mm, width_mm, each_mm},
         colour, 0);
  }
}

void SolidShapes::draw(const Shape& shape, const Vec3& place_W, const Mat3& axes, const Vec3& sizes_mm,
                       const Colour& colour, float gloss) const {
  Eigen::Matrix4f world_from_shape = Eigen::Matrix4f::Identity();
  world_from_shape.topLeftCorner<3, 3>() = (axes * sizes_mm.asDiagonal()).cast<float>();
  world_from_shape.topRightCorner<3, 1>() = place_W.cast<float>();
  const Eigen::Matrix4f camera_from_shape = camera_from_world_ * world_from_shape;
  const Eigen::Matrix3f normals =
      camera_from_world_.topLeftCorner<3, 3>() * (axes * sizes_mm.cwiseInverse().asDiagonal()).cast<float>();
  const GLuint program = used_;
  glUniformMatrix4fv(glGetUniformLocation(program, "camera_from_shape"), 1, GL_FALSE,
                     camera_from_shape.data());
  glUniformMatrix3fv(glGetUniformLocation(program, "normal_from_shape"), 1, GL_FALSE, normals.data());
  glUniform4fv(glGetUniformLocation(program, "base"), 1, colour.data());
  glUniform1f(glGetUniformLocation(program, "gloss"), gloss);
  glBindVertexArray(shape.vertex_array.get());
  glDrawArrays(GL_TRIANGLES, 0, shape.vertex_count);
}

}  // namespace osteomill
