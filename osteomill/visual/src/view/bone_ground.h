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

/// Estimates from the times of earlier frames how many triangles or pixels can be drawn in one frame. Reads
/// no clock itself.
class FrameBudget {
 public:
  /// Time for the bone in one frame, which leaves time for everything else at 30 frames per second.
  static constexpr double kBone_s = 0.018;

  /// The budget is never less than `min_count`, and initially `expected`.
  FrameBudget(std::size_t min_count, double expected)
      : min_count_(min_count), seconds_per_item_(kBone_s / expected) {}

  std::size_t min_count() const { return min_count_; }
  std::size_t budget() const {
    return std::max(min_count_, static_cast<std::size_t>(kBone_s / seconds_per_item_));
  }
  /// Records that drawing `count` took `passed_s`. Counts below `min_count` are raised to it, because a few
  /// do not predict many.
  void record_draw(std::size_t count, double passed_s) {
    constexpr double kWeight = 0.3;
    const double here = passed_s / static_cast<double>(std::max(count, min_count_));
    // Limits the effect of a frame that other processes delayed.
    seconds_per_item_ += kWeight * (std::min(here, 2 * seconds_per_item_) - seconds_per_item_);
  }

 private:
  std::size_t min_count_;
  double seconds_per_item_;
};

/// Draws the faces exposed by cuts: grey values, tinted by labels.
class ClipFaces {
 public:
  ClipFaces();
  void set(std::size_t cut, const ClipFace& face);
  /// Draws each face, clipped by the other cuts.
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

/// Background, bone and cuts, drawn into an image that is kept between frames. While the view moves,
/// triangles and pixels are limited by the time budget. When it rests, full detail is drawn brick by brick
/// into a second image, which replaces the first when complete. After milling, only the changed part of the
/// image is redrawn.
class BoneGround {
 public:
  BoneGround(const SurfaceBricks& layout, const GridGeometry& geometry,
             std::shared_ptr<const LabelMap> labels);

  void set_brick(std::size_t brick, const BrickLevels& levels);
  void set_clip_face(std::size_t cut, const ClipFace& face);
  std::size_t triangle_count() const { return bone_.triangle_count(); }

  /// Does one frame's work; `size` is that of the image at rest.
  void draw(const ViewScene& scene, const PixelSize& size);
  /// Draws once into a separate image, with half a frame's time budget.
  void draw_inset(const ViewScene& scene, const PixelSize& size);
  const FrameTarget& inset() const { return inset_->picture; }
  const FrameTarget& picture() const { return *shown_; }
  /// Returns true if nothing is left to draw as long as neither view nor bone changes.
  bool is_settled() const { return settled_ && changed_.empty() && bricks_to_reshade_.empty(); }

 private:
  void fit(const PixelSize& size);
  PixelSize size_within_budget(const PixelSize& size);
  void draw_at_once(const ViewScene& scene, const PixelSize& size);
  void begin_refining(const ViewScene& scene, const Projection& projection);
  void refine(const ViewScene& scene, const Projection& projection);
  bool draw_changed(const ViewScene& scene, const Projection& projection);
  /// Returns pixels from the lower left.
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
  // Receives full detail.
  std::optional<FrameTarget> resting_;
  // Points to whichever of the two is shown.
  const FrameTarget* shown_ = nullptr;
  // Window pixels per image pixel along each side while the view moves.
  int coarseness_ = 1;
  std::optional<CavityPass> cavities_;
  std::optional<Inset> inset_;
  std::optional<ViewScene> scene_;
  FrameBudget triangles_{20'000, 150'000};
  FrameBudget pixels_{500'000, 2'000'000};
  double cell_px_ = kFullDetail.cell_px;
  std::vector<VisibleBrick> to_refine_;
  std::size_t refined_ = 0;
  bool refining_ = false;
  bool settled_ = false;
  // Bricks changed since they were drawn: in the image shown, and in the one being refined.
  std::set<std::size_t> changed_;
  std::set<std::size_t> changed_while_refining_;
  // Bricks redrawn since, but with cavity darkening from an earlier frame.
  std::set<std::size_t> bricks_to_reshade_;
  unsigned drawn_ = 0;
};

}  // namespace osteomill
