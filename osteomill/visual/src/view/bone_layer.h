#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "osteomill/visual/brick_levels.h"
#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/scene.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/label_map.h"

#include "view/cavity_pass.h"
#include "view/gl_objects.h"

namespace osteomill {

/// Projection of a scene into a picture of one size: matrices and depth range.
struct Projection {
  PixelSize size;
  double near_mm;
  double far_mm;
  Eigen::Matrix4f camera_from_world;
  Eigen::Matrix4f clip_from_camera;
};
Projection projection_of(const ViewScene& scene, const PixelSize& size);
/// Sets the uniforms `camera_from_world` and `clip_from_camera` of the program in use.
void set_projection(GLuint program, const Projection& projection);

/// Returns a bounding sphere of a box of cells, each identified by its smallest voxel.
Sphere bounding_sphere(const GridGeometry& geometry, const VoxelBox& cells);

/// Returns a bounding box of the projected sphere, pixels from the lower left; the whole picture if the
/// sphere reaches the eye.
Eigen::AlignedBox2d projected_bounds(const ViewScene& scene, const Projection& projection,
                                     const Sphere& sphere);

/// Maximum depth drawn so far in each square tile of the picture: anything behind it is hidden and need not
/// be drawn.
class DepthTiles {
 public:
  /// Reads the depths back, which waits for all drawing to finish.
  DepthTiles(const FrameTarget& target, const Projection& projection, const Camera& camera);

  /// Returns whether the whole sphere is hidden.
  bool is_hidden(const Sphere& sphere) const;

 private:
  static constexpr int kTile_px = 16;

  Projection projection_;
  Camera camera_;
  int columns_;
  int rows_;
  // OpenGL depths, 0 to 1; rows from the top.
  std::vector<float> depths_;
};

/// Enables clipping by the scene's cuts, through the uniform `cuts` of the program in use, until `end_cuts`.
void begin_cuts(GLuint program, const ViewScene& scene);
void end_cuts();

/// Level of detail: each brick is drawn at the coarsest level (BrickLevels) whose cells are at most `cell_px`
/// wide in the picture.
struct Detail {
  double cell_px = 0;
  /// Region around the burr in which cells are at most a pixel wide.
  std::optional<Sphere> sharp;
};
/// So fine that a finer level would look the same.
inline const Detail kFullDetail{0.5, std::nullopt};

/// A brick that may be visible.
struct VisibleBrick {
  std::size_t brick;
  /// Level of BrickLevels to draw.
  std::size_t level;
  /// Size of a finest-level cell in the picture, at the brick's nearest point.
  double cell_px;
  /// Lies at least partly in `Detail::sharp`.
  bool sharp;
};

/// Cone of triangle normals: all lie within `spread_rad` about the axis. Initially unbounded.
struct NormalCone {
  Vec3 axis_W = Vec3::UnitZ();
  double spread_rad = 4;
};

/// The bone's surface in graphics memory, by brick, so that milling uploads only changed bricks.
class BoneLayer {
 public:
  /// `labels` of the bone; null for none.
  BoneLayer(const SurfaceBricks& layout, const GridGeometry& geometry,
            std::shared_ptr<const LabelMap> labels = nullptr);

  void set_brick(std::size_t brick, const BrickLevels& levels);

  /// Returns all bricks, including empty ones, that lie at least partly in the view frustum, nearest first.
  std::vector<std::size_t> bricks_in_view(const ViewScene& scene, const Projection& projection) const;
  /// Returns the bricks in view that may have front-facing triangles.
  std::vector<VisibleBrick> visible_bricks(const ViewScene& scene, const Projection& projection,
                                           const Detail& detail) const;
  /// Sets the levels of these bricks for another detail.
  void choose_levels(std::span<VisibleBrick> bricks, const Detail& detail) const;
  std::size_t triangle_count(std::span<const VisibleBrick> bricks) const;
  /// Draws back faces too if the scene has cuts.
  void draw(const ViewScene& scene, const Projection& projection, const CavityPass& cavities,
            std::span<const VisibleBrick> bricks) const;
  /// Returns the number of triangles in full detail.
  std::size_t triangle_count() const;
  const Sphere& bounds(std::size_t brick) const { return bricks_[brick].bounds; }

 private:
  struct Brick {
    gl::VertexArray vertex_array;
    gl::Buffer vertices;
    gl::Buffer indices;
    /// Vertex colours; unused without labels.
    gl::Buffer label_colours;
    std::array<BrickLevels::Range, BrickLevels::kCount> levels{};
    Sphere bounds;
    NormalCone facing;
    bool empty() const { return levels[0].count == 0; }
    bool is_facing_away(const Vec3& eye_W) const;
  };
  template <typename Wanted>
  std::vector<std::size_t> bricks_in_view(const ViewScene& scene, const Projection& projection,
                                          const Wanted& wanted) const;
  void set_label_colours(Brick& brick, const std::vector<MeshVertex>& vertices);

  // Separate programs without and with cuts, because clipping costs time per vertex.
  gl::Program whole_;
  gl::Program cut_;
  GridGeometry geometry_;
  std::shared_ptr<const LabelMap> labels_;
  std::vector<Brick> bricks_;
};

}  // namespace osteomill
