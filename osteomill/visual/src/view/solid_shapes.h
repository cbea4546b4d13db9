#pragma once

#include <array>

#include "view/bone_layer.h"
#include "view/gl_objects.h"

namespace osteomill {

/// Red, green, blue, opacity.
using Colour = std::array<float, 4>;

/// Draws spheres, cylinders and arrows: the tool, its ghost, contacts, forces.
class SolidShapes {
 public:
  SolidShapes();

  /// Selects lit drawing for the following shapes.
  void begin(const Projection& projection) const { begin(projection, program_.get()); }
  /// Selects a program made of `vertex_source()` and a custom fragment shader for the following shapes.
  void begin(const Projection& projection, GLuint program) const;
  static std::string_view vertex_source();

  void sphere(const Vec3& centre_W, double radius_mm, const Colour& colour) const;
  /// Draws a cylinder from `from_W` to `to_W` with flat ends.
  void cylinder(const Vec3& from_W, const Vec3& to_W, double radius_mm, const Colour& colour,
                float gloss = kGloss) const;
  /// Draws an arrow with a head; nothing if it is shorter than the thickness of its head.
  void arrow(const Vec3& from_W, const Vec3& along_mm, double radius_mm, const Colour& colour,
             int heads = 1) const;

 private:
  static constexpr float kGloss = 0.25f;
  struct Shape {
    gl::VertexArray vertex_array;
    gl::Buffer vertices;
    GLsizei vertex_count = 0;
  };
  static Shape make_surface_of_revolution(const std::vector<std::array<float, 4>>& outline);
  void draw(const Shape& shape, const Vec3& place_W, const Mat3& axes, const Vec3& sizes_mm,
            const Colour& colour, float gloss) const;

  gl::Program program_;
  Shape sphere_;
  Shape cylinder_;
  Shape cone_;
  mutable GLuint used_ = 0;
  mutable Eigen::Matrix4f camera_from_world_;
};

}  // namespace osteomill
