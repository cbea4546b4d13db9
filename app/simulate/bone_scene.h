#pragma once

#include <memory>

#include "osteomill/visual/image.h"
#include "osteomill/visual/scene_renderer.h"

#include "app/simulate/scene_of.h"

namespace osteomill::app {

/// The bone in the window: its surface and cuts, brought up to date from picture to picture. The window's
/// OpenGL context is current in every call.
class BoneScene {
 public:
  /// Begins with a bone of which nothing is drawn yet.
  void show(const SurfaceBricks& layout, const GridGeometry& geometry,
            std::shared_ptr<const LabelMap> labels);
  void clear() { renderer_.reset(); }

  /// Takes bricks of the surface that changed, and draws as many of those that wait as there is time for.
  void take(ChangedBricks changed, double pictures_per_s);
  /// Calls CutUpdates::update.
  void update_cuts(const ViewState& view, const BoneFollower& bone, const WindowLevel& grey_window,
                   const LabelMap* labels);
  /// Draws one picture into the window.
  void draw(const ViewScene& scene, const PixelSize& size);
  /// Draws a small picture of the scene over the one in the window, whose size is `window`; `corner`: its
  /// upper left one there.
  void draw_inset(const ViewScene& scene, const PixelSize& size, const Eigen::Vector2i& corner,
                  const PixelSize& window);
  /// Returns the picture of the scene in full detail.
  Image picture(const ViewScene& scene, const PixelSize& size);

  /// Returns whether no brick waits to be drawn.
  bool is_up_to_date() const { return waiting_.empty(); }
  std::size_t triangle_count() const { return renderer_ ? renderer_->triangle_count() : 0; }

 private:
  std::unique_ptr<SceneRenderer> renderer_;
  ChangedBricks waiting_;
  CutUpdates cuts_;
};

}  // namespace osteomill::app
