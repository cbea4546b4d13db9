#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "osteomill/visual/clip_face.h"
#include "osteomill/volume/label_map.h"

#include "view/bone_layer.h"
#include "view/cavity_pass.h"

namespace osteomill {

/// Learns how many triangles, or pixels, there is time for in one picture from the times of earlier pictures.
/// Reads no clock itself.
class DrawingPace {
 public:
  /// For the bone of one picture: in a thirtieth of a second it leaves time for all else.
  static constexpr double kBone_s = 0.018;

  /// There is always time for `min_count`, and at first for `expected`.
  DrawingPace(std::size_t min_count, double expected)
      : min_count_(min_count), seconds_per_item_(kBone_s / expected) {}

  std::size_t min_count() const { return min_count_; }
  std::size_t budget() const {
    return std::max(min_count_, static_cast<std::size_t>(kBone_s / seconds_per_item_));
  }
  /// Records that drawing `count` took `passed_s`. Fewer than `min_count` count as that number, because a few
  /// do not predict many.
  void record_draw(std::size_t count, double passed_s) {
    constexpr double kWeight = 0.3;
    const double here = passed_s / static_cast<double>(std::max(count, min_count_));
    // One that others of the machine held up counts little.
    seconds_per_item_ += kWeight * (std::min(here, 2 * seconds_per_item_) - seconds_per_item_);
  }

 private:
  std::size_t min_count_;
  double seconds_per_item_;
};

/// Draws what cuts lay open: grey values, tinted by labels.
class ClipFaces {
 public:
  ClipFaces();
  void set(std::size_t cut, const ClipFace& face);
  /// Draws each face as far as the other cuts leave it.
  void draw(const ViewScene& scene, const Projection& projection) const;

 private:
  struct Face {
    gl::VertexArray vertex_array;
    gl::Buffer corners;
    gl::Texture pixels;
  };
  gl::Program program_;
  std::array<Face, kMaxClipPlanes> faces_;
};

/// The ground on which the scene is drawn: background, bone and cuts in a picture of their own, which is kept
/// from one frame to the next. While the view moves it has as many triangles and pixels as there is time for.
/// If the view rests, full detail is drawn brick by brick into a second picture, which takes the first
/// one's place when it is done. If bone is milled only the part of the picture in which it changed is
/// drawn again.
class BoneGround {
 public:
  BoneGround(const SurfaceBricks& layout, const GridGeometry& geometry,
             std::shared_ptr<const LabelMap> labels);

  void set_brick(std::size_t brick, const BrickLevels& levels);
  void set_clip_face(std::size_t cut, const ClipFace& face);
  std::size_t triangle_count() const { return bone_.triangle_count(); }

  /// Does one picture's work; `size` is that of the picture when the view rests.
  void draw(const ViewScene& scene, const PixelSize& size);
  /// Draws once into a picture apart, in detail for which there is half a picture's time.
  void draw_inset(const ViewScene& scene, const PixelSize& size);
  const FrameTarget& inset() const { return inset_->picture; }
  const FrameTarget& picture() const { return *shown_; }
  /// Returns true if nothing is left to draw while neither view nor bone changes.
  bool is_settled() const { return settled_ && changed_.empty() && to_shade_.empty(); }

 private:
  void fit(const PixelSize& size);
  PixelSize affordable_size(const PixelSize& size);
  void draw_at_once(const ViewScene& scene, const PixelSize& size);
  void begin_refining(const ViewScene& scene, const Projection& projection);
  void refine(const ViewScene& scene, const Projection& projection);
  bool draw_changed(const ViewScene& scene, const Projection& projection);
  /// Pixels from the lower left.
  Eigen::AlignedBox2i changed_part(const std::set<std::size_t>& bricks, const ViewScene& scene,
                                   const Projection& projection) const;
  std::vector<VisibleBrick> visible_in_budget(const ViewScene& scene, const Projection& projection);
  void draw_surroundings(const ViewScene& scene, const Projection& projection);
  void update_cavities(const Projection& projection);

  struct Inset {
    explicit Inset(const PixelSize& size) : picture(size), cavities(size) {}
    FrameTarget picture;
    CavityPass cavities;
  };

  BoneLayer bone_;
  ClipFaces cut_faces_;
  gl::ScreenProgram background_;
  std::optional<FrameTarget> moving_;
  // Takes full detail.
  std::optional<FrameTarget> resting_;
  // The one of the two that is shown.
  const FrameTarget* shown_ = nullptr;
  // While the view moves, this number of the window's pixels along each side is one pixel of the picture.
  int coarseness_ = 1;
  std::optional<CavityPass> cavities_;
  std::optional<Inset> inset_;
  std::optional<ViewScene> scene_;
  DrawingPace triangles_{20'000, 150'000};
  DrawingPace pixels_{500'000, 2'000'000};
  double cell_px_ = kFullDetail.cell_px;
  std::vector<VisibleBrick> to_refine_;
  std::size_t refined_ = 0;
  bool refining_ = false;
  bool settled_ = false;
  // Bricks that changed since they were drawn: in the picture shown, and in the one that is being refined.
  std::set<std::size_t> changed_;
  std::set<std::size_t> changed_since_;
  // Bricks that were drawn again since, but with the darkening of an earlier picture.
  std::set<std::size_t> to_shade_;
  unsigned drawn_ = 0;
};

}  // namespace osteomill
