#pragma once

#include <array>
#include <vector>

#include "osteomill/view/bone_layer.h"
#include "osteomill/view/gl_objects.h"

namespace osteomill {

struct Colour {
  float red = 1;
  float green = 1;
  float blue = 1;
  float alpha = 1;
};

/// Draws spheres, cylinders and arrows: the tool, its ghost, contacts, forces.
class SolidShapes {
 public:
  SolidShapes();

  void begin(const Projection& projection) const;
  void sphere(const Vec3& centre_W, double radius_mm, const Colour& colour, float gloss = 0.25f) const;
  /// From `from_W` to `to_W`, closed by flat ends.
  void cylinder(const Vec3& from_W, const Vec3& to_W, double radius_mm, const Colour& colour,
                float gloss = 0.25f) const;
  /// With a head; none where shorter than its head would be thick.
  void arrow(const Vec3& from_W, const Vec3& along_mm, double radius_mm, const Colour& colour,
             int heads = 1) const;

 private:
  struct Shape {
    gl::VertexArray vertex_array;
    gl::Buffer vertices;
    GLsizei vertex_count = 0;
  };
  static Shape turned(const std::vector<std::array<float, 4>>& outline);
  void draw(const Shape& shape, const Vec3& place_W, const Mat3& axes, const Vec3& sizes_mm,
            const Colour& colour, float gloss) const;

  gl::Program program_;
  Shape sphere_;
  Shape cylinder_;
  Shape cone_;
  mutable Eigen::Matrix4f camera_from_world_;
};

}  // namespace osteomill
