#pragma once

#include <memory>

#include "osteomill/visual/image.h"
#include "osteomill/visual/scene_renderer.h"

#include "app/simulate/scene_of.h"

namespace osteomill::app {

/// The bone's surface and cuts in the window, updated every frame. The window's OpenGL context must be
/// current in every call.
class BoneScene {
 public:
  /// Starts with a bone without any triangles.
  void show(const SurfaceBricks& layout, const GridGeometry& geometry,
            std::shared_ptr<const LabelMap> labels);
  void clear() { renderer_.reset(); }

  /// Adds changed bricks and uploads as many pending ones as the time budget allows.
  void take(ChangedBricks changed, double frames_per_s);
  /// Calls CutUpdates::update.
  void update_cuts(const ViewState& view, const BoneFollower& bone, const WindowLevel& grey_window,
                   const LabelMap* labels);
  /// Draws one frame into the window.
  void draw(const ViewScene& scene, const PixelSize& size);
  /// Draws an inset of the scene over the window's frame, whose size is `window`, with its upper left corner
  /// at `corner`.
  void draw_inset(const ViewScene& scene, const PixelSize& size, const Eigen::Vector2i& corner,
                  const PixelSize& window);
  /// Renders the scene in full detail.
  Image picture(const ViewScene& scene, const PixelSize& size);

  /// Returns whether no brick is waiting for upload.
  bool is_up_to_date() const { return waiting_.empty(); }
  std::size_t triangle_count() const { return renderer_ ? renderer_->triangle_count() : 0; }

 private:
  std::unique_ptr<SceneRenderer> renderer_;
  ChangedBricks waiting_;
  CutUpdates cuts_;
};

}  // namespace osteomill::app
