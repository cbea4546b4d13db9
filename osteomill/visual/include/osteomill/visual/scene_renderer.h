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

/// Draws scenes with OpenGL 3.3 core: bone, tool and ghost, contact, arrows, cuts. For one thread, whose
/// OpenGL context (offscreen_context.h or a window's) must be current in every call and at construction and
/// destruction. Throws std::runtime_error if OpenGL fails.
class SceneRenderer {
 public:
  /// `labels` of the bone; null for none.
  SceneRenderer(const SurfaceBricks& layout, const GridGeometry& geometry,
                std::shared_ptr<const LabelMap> labels = nullptr);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Replaces a brick's triangles; without triangles the brick is removed.
  void set_brick(std::size_t brick, const BrickLevels& levels);
  /// Sets the face exposed by this cut of the scene. Parts removed by other cuts are not drawn.
  void set_clip_face(std::size_t cut, const ClipFace& face);

  /// Draws a frame offscreen, in a time that hardly depends on the number of triangles and pixels: at reduced
  /// detail while the view moves; in full detail and `size` some calls after it has come to rest. Cavities
  /// are darkened using the depths of the previous frame, so a still picture is complete only after two
  /// calls.
  void draw(const ViewScene& scene, const PixelSize& size);
  /// Returns whether drawing the same scene again would change nothing: the frame has full detail.
  bool is_settled() const;
  /// Returns the last frame.
  Image picture() const;
  /// Copies the last frame into the window's framebuffer, which has the size passed to `draw`.
  void copy_to_window() const;

  /// Draws the bone offscreen once more, for a magnifier inset, with half the triangle budget. Call after
  /// `draw`.
  void draw_inset(const ViewScene& scene, const PixelSize& size);
  /// Copies the inset into the window's framebuffer, with its lower left corner at this pixel.
  void copy_inset_to_window(int left_px, int bottom_px) const;

  std::size_t triangle_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads the pixels of an OpenGL framebuffer; 0 is the window's.
Image read_framebuffer(unsigned framebuffer, const PixelSize& size);

}  // namespace osteomill
