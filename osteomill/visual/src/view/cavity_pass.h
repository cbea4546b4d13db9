#pragma once

#include "osteomill/visual/camera.h"

#include "view/gl_objects.h"

namespace osteomill {

/// Blurs the depths of a picture at a fraction of its size, for the next picture to tell what is sunk below
/// its surroundings (after Luft, Colditz and Deussen 2006, whose unsharp mask of the depth buffer this is).
class CavityPass {
 public:
  /// The blur reaches about `reach_px`, pixels of the picture.
  explicit CavityPass(const PixelSize& size, int reach_px = 24);

  void blur(GLuint depths, double near_mm, double far_mm) const;
  /// A texture of two channels: blurred depths in mm times a weight, and that weight (0: nothing was drawn).
  GLuint blurred_depths() const { return blurred_.texture.get(); }
  /// Returns how far the blur reaches in a picture of the same view of this size.
  double reach_px(const PixelSize& picture) const { return reach_of_height_ * picture.height; }

 private:
  /// A texture of two floats a pixel that is drawn into.
  struct Layer {
    Layer(const PixelSize& size, GLint filter);
    gl::Texture texture;
    gl::Framebuffer framebuffer;
  };
  void draw(const gl::ScreenProgram& program, const Layer& target, GLuint source) const;

  double reach_of_height_;
  PixelSize size_;
  Layer small_;
  Layer half_blurred_;
  Layer blurred_;
  gl::ScreenProgram linear_depth_;
  gl::ScreenProgram blur_;
};

}  // namespace osteomill
