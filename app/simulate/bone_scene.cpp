#include "app/simulate/bone_scene.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace osteomill::app {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMaxPictures = 500;

}  // namespace

void BoneScene::show(const SurfaceBricks& layout, const GridGeometry& geometry,
                     std::shared_ptr<const LabelMap> labels) {
  cuts_ = {};
  waiting_.clear();
  renderer_ = std::make_unique<SceneRenderer>(layout, geometry, std::move(labels));
}

void BoneScene::take(ChangedBricks changed, double frames_per_s) {
  changed.merge(waiting_);
  waiting_ = std::move(changed);
  // All bricks of a large bone do not fit into one frame. But if frames are slow anyway, e.g. without a
  // graphics card, a small budget would take minutes.
  const std::chrono::duration<double> longest(std::max(0.02, 0.5 / std::max(frames_per_s, 1.0)));
  for (const auto start = Clock::now(); !waiting_.empty() && Clock::now() - start < longest;
       waiting_.erase(waiting_.begin())) {
    renderer_->set_brick(waiting_.begin()->first, waiting_.begin()->second);
  }
}

void BoneScene::update_cuts(const ViewState& view, const BoneFollower& bone, const WindowLevel& grey_window,
                            const LabelMap* labels) {
  cuts_.update(view, bone, grey_window, labels, *renderer_);
}

void BoneScene::draw(const ViewScene& scene, const PixelSize& size) {
  renderer_->draw(scene, size);
  renderer_->copy_to_window();
}

void BoneScene::draw_inset(const ViewScene& scene, const PixelSize& size, const Eigen::Vector2i& corner,
                           const PixelSize& window) {
  renderer_->draw_inset(scene, size);
  renderer_->copy_inset_to_window(corner.x(), window.height - corner.y() - size.height);
}

Image BoneScene::picture(const ViewScene& scene, const PixelSize& size) {
  renderer_->draw(scene, size);
  for (int n = 0; n < kMaxPictures && !renderer_->is_settled(); ++n) renderer_->draw(scene, size);
  return renderer_->picture();
}

}  // namespace osteomill::app
