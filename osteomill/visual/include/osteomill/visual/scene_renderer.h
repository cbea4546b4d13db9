#pragma once

#include <cstddef>
#include <memory>

#include "osteomill/visual/brick_levels.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/visual/image.h"
#include "osteomill/visual/scene.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Draws scenes with OpenGL 3.3 core: bone, tool and ghost, contact, arrows, cuts. Used by one thread, in
/// whose context (offscreen_context.h, or a window's) it was made; that context is current at every call and
/// at the end. Throws std::runtime_error if OpenGL refuses something.
class SceneRenderer {
 public:
  /// `labels` are those of the bone; null for none.
  SceneRenderer(const SurfaceBricks& layout, const GridGeometry& geometry,
                std::shared_ptr<const LabelMap> labels = nullptr);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Sets a brick's triangles as they are now; without any the brick is removed.
  void set_brick(std::size_t brick, const BrickLevels& levels);
  /// Sets the face that the scene's cut of this number lays open. The part that other cuts remove is not
  /// drawn.
  void set_clip_face(std::size_t cut, const ClipFace& face);

  /// Draws into a picture of its own, in a time that hardly depends on how many triangles and pixels there
  /// are: while the view moves, with as many as there is time for; some calls after it has come to rest, in
  /// full detail and `size`. What lies deep is darkened by the depths of the picture drawn before, so that a
  /// still picture is complete only when it was drawn twice.
  void draw(const ViewScene& scene, const PixelSize& size);
  /// Returns whether drawing the same again would change nothing: the picture has full detail.
  bool is_settled() const;
  /// Returns the picture drawn last.
  Image picture() const;
  /// Copies it into the window's framebuffer, which has the size that was asked for.
  void copy_to_window() const;

  /// Draws the bone once more into a small picture of its own, as from a loupe; at once, with half as many
  /// triangles as there is time for. Only after `draw`.
  void draw_inset(const ViewScene& scene, const PixelSize& size);
  /// Copies that into the window's framebuffer, with its lower left corner at this pixel.
  void copy_inset_to_window(int left_px, int bottom_px) const;

  std::size_t triangle_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads the picture that an OpenGL framebuffer holds; 0 is the window's.
Image read_framebuffer(unsigned framebuffer, const PixelSize& size);

}  // namespace osteomill
