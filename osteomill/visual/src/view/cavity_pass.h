#pragma once

#include "osteomill/visual/camera.h"

#include "view/gl_objects.h"

namespace osteomill {

/// Blurs the depth buffer at reduced size. The next frame uses it to detect cavities: points deeper than
/// their surroundings (unsharp masking of the depth buffer, Luft, Colditz and Deussen 2006).
class CavityPass {
 public:
  /// The blur radius is about `reach_px`, pixels of the picture.
  explicit CavityPass(const PixelSize& size, int reach_px = 24);

  void blur(GLuint depths, double near_mm, double far_mm) const;
  /// Returns a two-channel texture: blurred depth in mm times a weight, and that weight (0: nothing was
  /// drawn).
  GLuint blurred_depths() const { return blurred_.texture.get(); }
  /// Returns the blur radius in a picture of this size of the same view.
  double reach_px(const PixelSize& picture) const { return reach_of_height_ * picture.height; }

 private:
  /// A render target of two floats per pixel.
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
