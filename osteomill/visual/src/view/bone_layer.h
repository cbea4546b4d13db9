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

/// The projection of a scene into a picture of one size: the matrices, and the range of depths it covers.
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

/// A sphere around a box of cells, each named by its least voxel.
Sphere bounding_sphere(const GridGeometry& geometry, const VoxelBox& cells);

/// Returns a box, in pixels from the lower left, outside of which no part of the sphere is drawn; the whole
/// picture if the sphere reaches the eye.
Eigen::AlignedBox2d drawn_within(const ViewScene& scene, const Projection& projection, const Sphere& sphere);

/// The greatest depth that was drawn so far in each small square of the picture: what lies behind it is
/// hidden and need not be drawn.
class DepthTiles {
 public:
  /// Reads the depths, which waits for all drawing.
  DepthTiles(const FrameTarget& target, const Projection& projection, const Camera& camera);

  /// Returns whether all of the sphere lies behind what was drawn.
  bool is_hidden(const Sphere& sphere) const;

 private:
  static constexpr int kTile_px = 16;

  Projection projection_;
  Camera camera_;
  int columns_;
  int rows_;
  // Depths as OpenGL keeps them, 0 to 1; rows from the top.
  std::vector<float> depths_;
};

/// Has OpenGL clip by the scene's cuts, by the uniform `cuts` of the program in use, until `end_cuts`.
void begin_cuts(GLuint program, const ViewScene& scene);
void end_cuts();

/// The detail at which the bone is drawn: each brick at the coarsest of its levels (BrickLevels) whose cells
/// are at most this wide in the picture.
struct Detail {
  double cell_px = 0;
  /// In here, where the burr works, a cell is at most a pixel wide.
  std::optional<Sphere> sharp;
};
/// So fine that a finer level would look the same.
inline const Detail kFullDetail{0.5, std::nullopt};

/// A brick that the camera may see.
struct VisibleBrick {
  std::size_t brick;
  /// The level of BrickLevels to draw it at.
  std::size_t level;
  /// The width of a cell of the finest level in the picture, where the brick is nearest.
  double cell_px;
  /// It lies at least in part in `Detail::sharp`.
  bool sharp;
};

/// The directions that triangles face: their normals all lie within this half angle about this axis. At
/// first, anywhere.
struct Facing {
  Vec3 axis_W = Vec3::UnitZ();
  double spread_rad = 4;
};

/// The bone's surface in graphics memory, brick by brick, so that milling replaces only the bricks that
/// changed.
class BoneLayer {
 public:
  /// `labels` are those of the bone; null for none.
  BoneLayer(const SurfaceBricks& layout, const GridGeometry& geometry,
            std::shared_ptr<const LabelMap> labels = nullptr);

  void set_brick(std::size_t brick, const BrickLevels& levels);

  /// Returns all bricks, empty ones too, that lie at least in part where the camera looks, the nearest first.
  std::vector<std::size_t> bricks_in_view(const ViewScene& scene, const Projection& projection) const;
  /// Returns those of them whose triangles the camera may see.
  std::vector<VisibleBrick> visible_bricks(const ViewScene& scene, const Projection& projection,
                                           const Detail& detail) const;
  /// Sets the levels of these bricks for another detail.
  void choose_levels(std::span<VisibleBrick> bricks, const Detail& detail) const;
  std::size_t triangle_count(std::span<const VisibleBrick> bricks) const;
  /// Draws back faces too if the scene is cut open.
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
    /// The colours of the vertices; none if there are no labels.
    gl::Buffer label_colours;
    std::array<BrickLevels::Range, BrickLevels::kCount> levels{};
    Sphere bounds;
    Facing facing;
    bool empty() const { return levels[0].count == 0; }
    bool is_facing_away(const Vec3& eye_W) const;
  };
  template <typename Wanted>
  std::vector<std::size_t> bricks_in_view(const ViewScene& scene, const Projection& projection,
                                          const Wanted& wanted) const;
  void set_label_colours(Brick& brick, const std::vector<MeshVertex>& vertices);

  // Without cuts and with them, since clipping costs time at every vertex.
  gl::Program whole_;
  gl::Program cut_;
  GridGeometry geometry_;
  std::shared_ptr<const LabelMap> labels_;
  std::vector<Brick> bricks_;
};

}  // namespace osteomill
