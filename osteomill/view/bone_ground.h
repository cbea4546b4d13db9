#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "osteomill/view/bone_layer.h"
#include "osteomill/view/cavity_pass.h"
#include "osteomill/view/clip_faces.h"
#include "osteomill/view/frame_target.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// How many triangles may be drawn for one picture so that pictures follow each other quickly, from how long
/// those before took. No clock of its own.
class DrawingPace {
 public:
  /// Leaves room in a thirtieth of a second for the tool, the panels and showing it all.
  static constexpr double kBone_s = 0.018;
  static constexpr std::size_t kFewest = 20'000;

  std::size_t triangles() const {
    return std::max(kFewest, static_cast<std::size_t>(kBone_s / s_per_triangle_));
  }
  /// So many took so long. Pictures of a few say nothing of what many take.
  void drew(std::size_t triangles, double passed_s) {
    const double here = passed_s / static_cast<double>(std::max(triangles, kFewest));
    // One that others of the machine held up counts little.
    s_per_triangle_ += kWeight * (std::min(here, 2 * s_per_triangle_) - s_per_triangle_);
  }

 private:
  static constexpr double kWeight = 0.3;
  double s_per_triangle_ = kBone_s / 150'000;
};

/// The bone with all that stands still beside it, in a picture of its own, however many triangles it has:
/// while the view moves with as many as there is time for; where it rests in full detail, brick by brick in a
/// second picture that takes the first one's place when it is done; and where bone is milled only the part of
/// the picture in which it changed.
class BoneGround {
 public:
  BoneGround(const SurfaceBricks& layout, const GridGeometry& geometry,
             std::shared_ptr<const LabelMap> labels);

  void set_brick(std::size_t brick, const BrickMesh& mesh, const BrickLevels& levels);
  void set_clip_face(std::size_t cut, const ClipFace& face);
  std::size_t triangle_count() const { return bone_.triangle_count(); }

  /// One picture's work.
  void draw(const ViewScene& scene, const Projection& projection);
  const FrameTarget& picture() const { return *shown_; }
  /// Nothing is left to be drawn while neither view nor bone changes.
  bool settled() const { return settled_ && changed_.empty() && to_shade_.empty(); }

 private:
  struct Rectangle {
    int left, bottom, width, height;
  };

  void fit(const PixelSize& size);
  void draw_at_once(const ViewScene& scene, const Projection& projection);
  void begin_refining(const ViewScene& scene, const Projection& projection);
  void refine(const ViewScene& scene, const Projection& projection);
  bool draw_changed(const ViewScene& scene, const Projection& projection);
  Rectangle changed_part(const std::set<std::size_t>& bricks, const ViewScene& scene,
                         const Projection& projection) const;
  std::vector<SeenBrick> seen_in_time(const ViewScene& scene, const Projection& projection);
  void draw_around(const ViewScene& scene, const Projection& projection);
  void look_for_cavities(const Projection& projection);

  BoneLayer bone_;
  ClipFaces cut_faces_;
  gl::Program background_;
  gl::VertexArray nothing_;
  std::optional<FrameTarget> shown_;
  // Where full detail is drawn.
  std::optional<FrameTarget> next_;
  std::optional<CavityPass> cavities_;
  std::optional<ViewScene> scene_;
  DrawingPace pace_;
  double cell_px_ = kFullDetail.cell_px;
  std::vector<SeenBrick> to_refine_;
  std::size_t refined_ = 0;
  bool refining_ = false;
  bool settled_ = false;
  // Bricks that are drawn as they were: in the picture shown, and since refining began.
  std::set<std::size_t> changed_;
  std::set<std::size_t> changed_since_;
  // Drawn since, but with the darkening of a picture before.
  std::set<std::size_t> to_shade_;
  unsigned drawn_ = 0;
};

}  // namespace osteomill
