#pragma once

#include "osteomill/visual/scene.h"

#include "view/bone_layer.h"
#include "view/gl_objects.h"
#include "view/solid_shapes.h"

namespace osteomill {

/// Darkens bone close to the simulated tool, which keeps light from it: by the share of the sky over the bone
/// that the burr's ball hides, and by that of the shaft's rod, as far as three of their radii from their
/// axes. It is drawn over the finished picture of the bone, which need not be drawn again when the tool
/// moves.
class ContactShadow {
 public:
  /// The share of the light that each of the two takes where it touches.
  static constexpr double kDarkest = 0.65;

  ContactShadow();

  /// Draws into the picture that is bound, which has the colours and depths of `ground` and no tool yet;
  /// `scene` has one.
  void draw(const ViewScene& scene, const Projection& projection, const FrameTarget& ground,
            const SolidShapes& shapes) const;

 private:
  gl::Program program_;
};

/// Draws bone and cuts as a veil over a tool that was drawn alone.
class BoneVeil {
 public:
  /// The share of the bone's colour in front of the tool.
  static constexpr float kShare = 0.45f;

  BoneVeil();

  /// Prepares the picture that is bound for the simulated tool alone, to be drawn in colours with an alpha of
  /// `kShare`. Keeps drawing to where the tool is until `end`.
  void begin(const ViewScene& scene, const Projection& projection) const;
  /// Draws the veil.
  void end(const FrameTarget& ground) const;

 private:
  gl::ScreenProgram program_;
};

}  // namespace osteomill
