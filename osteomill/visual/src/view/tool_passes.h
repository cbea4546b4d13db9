#pragma once

#include "osteomill/visual/scene.h"

#include "view/bone_layer.h"
#include "view/gl_objects.h"
#include "view/solid_shapes.h"

namespace osteomill {

/// Ambient shadow of the simulated tool: darkens nearby bone by the fraction of the sky that the burr's
/// sphere hides, and by that of the shaft's cylinder, up to 2.5 radii from their axes. Drawn over the
/// finished picture of the bone, which need not be redrawn when the tool moves.
class ContactShadow {
 public:
  /// Fraction of the light that each of the two removes on contact.
  static constexpr double kDarkest = 0.65;

  ContactShadow();

  /// Draws into the bound framebuffer, which holds the colours and depths of `ground` without the tool;
  /// `scene` must have a tool.
  void draw(const ViewScene& scene, const Projection& projection, const FrameTarget& ground,
            const SolidShapes& shapes) const;

 private:
  gl::Program program_;
};

/// Draws bone and cuts as a translucent veil over the tool, which is drawn first.
class BoneVeil {
 public:
  /// Opacity of the bone in front of the tool.
  static constexpr float kShare = 0.45f;

  BoneVeil();

  /// Prepares the bound framebuffer for drawing the simulated tool alone, in colours with an alpha of
  /// `kShare`. Restricts drawing to the tool's screen area until `end`.
  void begin(const ViewScene& scene, const Projection& projection) const;
  /// Draws the veil over the tool.
  void end(const FrameTarget& ground) const;

 private:
  gl::ScreenProgram program_;
};

}  // namespace osteomill
