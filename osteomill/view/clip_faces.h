#pragma once

#include <array>

#include "osteomill/view/bone_layer.h"
#include "osteomill/view/clip_face.h"
#include "osteomill/view/gl_objects.h"

namespace osteomill {

/// What cuts lay open: grey values, tinted by labels.
class ClipFaces {
 public:
  ClipFaces();
  void set(std::size_t cut, const ClipFace& face);
  /// Each face as far as the other cuts leave it.
  void draw(const ViewScene& scene, const Projection& projection) const;

 private:
  struct Face {
    gl::VertexArray vertex_array;
    gl::Buffer corners;
    gl::Texture pixels;
  };
  gl::Program program_;
  std::array<Face, kMaxClipPlanes> faces_;
};

}  // namespace osteomill
