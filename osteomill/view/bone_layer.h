#pragma once

#include <cstddef>
#include <vector>

#include "osteomill/surface/brick_mesh.h"
#include "osteomill/surface/surface_bricks.h"
#include "osteomill/view/cavity_pass.h"
#include "osteomill/view/gl_objects.h"
#include "osteomill/view/scene.h"
#include "osteomill/volume/grid_geometry.h"

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

/// Holds a box of cells, each named by its least voxel.
Sphere bounding_sphere(const GridGeometry& geometry, const VoxelBox& cells);

/// The bricks, empty or not, that lie at least in part where the camera sees, the nearest first.
std::vector<std::size_t> bricks_in_view(const SurfaceBricks& layout, const GridGeometry& geometry,
                                        const ViewScene& scene, const Projection& projection);

/// Hands the scene's cuts to the uniform `cuts` of the program in use and has OpenGL clip by them. Ends with
/// `end_cuts`.
void begin_cuts(GLuint program, const ViewScene& scene);
void end_cuts();

/// The bone's surface, a piece of graphics memory a brick, so that milling replaces only what changed.
class BoneLayer {
 public:
  BoneLayer(const SurfaceBricks& layout, const GridGeometry& geometry);

  void clear();
  void set_brick(std::size_t brick, const BrickMesh& mesh);
  /// Only bricks that the camera may see, the nearest first; back faces only where the scene is cut open.
  void draw(const ViewScene& scene, const Projection& projection, const CavityPass& cavities) const;
  std::size_t triangle_count() const;

 private:
  struct Brick {
    gl::VertexArray vertex_array;
    gl::Buffer vertices;
    gl::Buffer indices;
    GLsizei index_count = 0;
    Sphere bounds;
    /// The triangles' normals all lie within this half angle about this axis.
    Vec3 facing_W = Vec3::UnitZ();
    double facing_spread_rad = 4;
    bool turned_away(const Vec3& eye_W) const;
  };
  std::vector<const Brick*> seen_bricks(const ViewScene& scene, const Projection& projection) const;

  // Clipping costs time at every vertex.
  gl::Program whole_;
  gl::Program cut_;
  SurfaceBricks layout_;
  GridGeometry geometry_;
  std::vector<Brick> bricks_;
};

}  // namespace osteomill
