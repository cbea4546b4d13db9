#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "osteomill/surface/brick_levels.h"
#include "osteomill/surface/brick_mesh.h"
#include "osteomill/surface/surface_bricks.h"
#include "osteomill/view/cavity_pass.h"
#include "osteomill/view/gl_objects.h"
#include "osteomill/view/scene.h"
#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// The camera's matrices and depths, as every layer is drawn with them.
struct Projection {
  PixelSize size;
  double near_mm;
  double far_mm;
  Eigen::Matrix4f camera_from_world;
  Eigen::Matrix4f clip_from_camera;
};
Projection projection_of(const ViewScene& scene, const PixelSize& size);
/// Hands both matrices to the uniforms of these names of the program in use.
void set_projection(GLuint program, const Projection& projection);

/// Holds a box of cells, each named by its least voxel.
Sphere bounding_sphere(const GridGeometry& geometry, const VoxelBox& cells);

/// The bricks, empty or not, that lie at least in part where the camera sees, the nearest first.
std::vector<std::size_t> bricks_in_view(const SurfaceBricks& layout, const GridGeometry& geometry,
                                        const ViewScene& scene, const Projection& projection);

/// What was drawn so far as the greatest depth in each small square of the picture: what lies behind need not
/// be drawn.
class DepthTiles {
 public:
  /// Reads the depths, which waits for all drawing.
  DepthTiles(const FrameTarget& target, const Projection& projection, const Camera& camera);

  /// Whether all of the sphere lies behind what was drawn.
  bool hide(const Sphere& sphere) const;

 private:
  static constexpr int kTile_px = 16;

  Projection projection_;
  Camera camera_;
  int columns_;
  int rows_;
  // As OpenGL keeps depths, 0 to 1; rows from the top.
  std::vector<float> depths_;
};

/// Hands the scene's cuts to the uniform `cuts` of the program in use and has OpenGL clip by them. Ends with
/// `end_cuts`.
void begin_cuts(GLuint program, const ViewScene& scene);
void end_cuts();

/// How closely the bone is looked at: a brick is drawn at the coarsest level whose cells are no wider in the
/// picture than this.
struct Detail {
  double cell_px = 0;
  /// No coarser than a pixel in here.
  std::optional<Sphere> sharp;
};
/// All that can be told apart.
inline constexpr Detail kFullDetail{0.5, std::nullopt};

/// A brick that the camera may see, and how closely.
struct SeenBrick {
  std::size_t brick;
  std::size_t level;
  /// How wide a cell of the finest level is in the picture where the brick is nearest.
  double cell_px;
  bool sharp;
};

/// The bone's surface, a piece of graphics memory a brick, so that milling replaces only what changed.
class BoneLayer {
 public:
  /// `labels` are those of the bone; null for none.
  BoneLayer(const SurfaceBricks& layout, const GridGeometry& geometry,
            std::shared_ptr<const LabelMap> labels = nullptr);

  void set_brick(std::size_t brick, const BrickMesh& mesh, const BrickLevels& levels);

  /// Only bricks that the camera may see, the nearest first.
  std::vector<SeenBrick> seen(const ViewScene& scene, const Projection& projection,
                              const Detail& detail) const;
  /// The same bricks in another detail.
  void choose_levels(std::span<SeenBrick> bricks, const Detail& detail) const;
  std::size_t triangle_count(std::span<const SeenBrick> bricks) const;
  /// Back faces only where the scene is cut open.
  void draw(const ViewScene& scene, const Projection& projection, const CavityPass& cavities,
            std::span<const SeenBrick> bricks) const;
  /// In full detail.
  std::size_t triangle_count() const;
  const Sphere& bounds(std::size_t brick) const { return bricks_[brick].bounds; }

 private:
  struct Brick {
    gl::VertexArray vertex_array;
    gl::Buffer vertices;
    gl::Buffer indices;
    /// Of the vertices; none where there are no labels.
    gl::Buffer label_colours;
    std::array<BrickLevels::Range, BrickLevels::kCount> levels{};
    Sphere bounds;
    /// The triangles' normals all lie within this half angle about this axis.
    Vec3 facing_W = Vec3::UnitZ();
    double facing_spread_rad = 4;
    bool empty() const { return levels[0].count == 0; }
    bool turned_away(const Vec3& eye_W) const;
  };
  void set_label_colours(Brick& brick, const std::vector<MeshVertex>& vertices);

  // Clipping costs time at every vertex.
  gl::Program whole_;
  gl::Program cut_;
  GridGeometry geometry_;
  std::shared_ptr<const LabelMap> labels_;
  std::vector<Brick> bricks_;
};

}  // namespace osteomill
