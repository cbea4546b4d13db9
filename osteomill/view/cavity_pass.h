#pragma once

#include "osteomill/view/camera.h"
#include "osteomill/view/gl_objects.h"

namespace osteomill {

/// Blurs the depths of a picture at a fraction of its size, for the next picture to tell what is sunk below
/// its surroundings (after Luft, Colditz and Deussen 2006, whose unsharp mask of the depth buffer this is).
class CavityPass {
 public:
  /// The blur reaches about `reach_px`, pixels of the picture.
  explicit CavityPass(const PixelSize& size, int reach_px = 24);

  void blur(GLuint depths, double near_mm, double far_mm) const;
  /// A texture of two channels: blurred depths in mm times a weight, and that weight (0: nothing was drawn).
  GLuint blurred_depths() const { return blurred_.get(); }
  /// How far the blur reaches in a picture of the same view of this size.
  double reach_px(const PixelSize& picture) const { return reach_of_height_ * picture.height; }

 private:
  void draw(const gl::ScreenProgram& program, const gl::Framebuffer& target, GLuint source) const;

  double reach_of_height_;
  PixelSize size_;
  gl::Texture small_;
  gl::Texture half_blurred_;
  gl::Texture blurred_;
  gl::Framebuffer to_small_;
  gl::Framebuffer to_half_blurred_;
  gl::Framebuffer to_blurred_;
  gl::ScreenProgram linear_depth_;
  gl::ScreenProgram blur_;
};

}  // namespace osteomill
