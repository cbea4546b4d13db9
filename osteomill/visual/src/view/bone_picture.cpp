#include "osteomill/visual/bone_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "osteomill/visual/annotations.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/visual/offscreen_context.h"
#include "osteomill/visual/surface_mesh.h"
#include "osteomill/volume/sampling.h"

#include "view/bone_layer.h"
#include "view/cavity_pass.h"

namespace osteomill {

namespace {

constexpr double kFieldOfView_rad = 0.04;
constexpr double kMaxWhole_mm = 45.0;
constexpr double kAroundEntry_mm = 24.0;
// Minimum number of voxels around the entry; fewer show no recognisable shape.
constexpr double kAroundEntry_voxels = 32;
constexpr double kMargin = 1.0 / 20;
// Rendered pixels per picture pixel, along each side.
constexpr int kSupersampling = 2;
// Radius of cavity darkening as a fraction of the picture's height: about a burr's radius.
constexpr double kCavityReach = 1.0 / 16;
// Picture height for which annotations are laid out, px. They grow with larger pictures; in smaller ones they
// keep their size, to stay legible.
constexpr double kAnnotatedHeight_px = 480;
// Light reflected by white paper.
constexpr std::array<float, 3> kLightFromBelow{0.47f, 0.45f, 0.42f};
// Maximum size of the surface in memory at once.
constexpr std::size_t kTrianglesAtOnce = 400'000;

// Centre of the bone, and its height or width in the camera's view, whichever is larger.
struct Extent {
  Vec3 centre_W;
  double size_mm;
};

Extent extent_of_bone(const Volume& bone, const Camera& camera) {
  const Mat3 axes = camera.orientation.toRotationMatrix();
  const GridGeometry& geometry = bone.geometry();
  Eigen::AlignedBox3d box;
  const auto include = [&](const VoxelBox& voxels) {
    for (const Vec3& corner_W : corners_W(geometry, voxels)) box.extend(axes.transpose() * corner_W);
  };
  for_each(geometry.all_voxels().bricks(BlockRanges::kBrickVoxels), [&](const VoxelIndex& brick) {
    if (static_cast<double>(bone.ranges().at(brick).max) > bone.isovalue())
      include(BlockRanges::covered_voxels(brick, geometry));
  });
  if (box.isEmpty()) include(geometry.all_voxels());
  return {axes * box.center(), std::max(box.sizes().head<2>().maxCoeff(), 1e-3)};
}

ViewScene scene_with(const Volume& bone, double reference_density, const Camera& camera) {
  ViewScene scene;
  scene.camera = camera;
  scene.bounds = bounding_sphere(bone.geometry(), bone.geometry().all_voxels());
  scene.isovalue = bone.isovalue();
  scene.reference_density = reference_density;
  scene.light_from_below = kLightFromBelow;
  return scene;
}

// Samples colours deeper below the surface, beyond the scanner's blur; fast enough for still pictures only.
void deepen_density(const Volume& bone, MeshVertex& vertex) {
  const double voxel_mm = bone.geometry().spacing_mm.minCoeff();
  for (const double voxels : {1.25, 2.5}) {
    const Vec3 below_W = vec3_of(vertex.position_mm) - voxels * voxel_mm * vec3_of(vertex.normal);
    vertex.density = std::max(vertex.density, static_cast<float>(density_at(bone.grid(), below_W)));
  }
}

// Draws the bone without ever holding the whole surface in memory.
class BonePainter {
 public:
  BonePainter(const Volume& bone, const ViewScene& scene, const PixelSize& size)
      : bone_(bone),
        scene_(scene),
        projection_(projection_of(scene, size)),
        layer_(SurfaceBricks(bone.geometry().dims), bone.geometry(), bone.labels()),
        target_(size),
        cavities_(size, std::max(1, static_cast<int>(kCavityReach * size.height))) {}

  Image paint() {
    target_.bind();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    // First pass for the depths, which show hidden bricks and cavities; second pass for colours.
    const std::vector<std::size_t> visible = draw(layer_.bricks_in_view(scene_, projection_));
    cavities_.blur(target_.depths(), projection_.near_mm, projection_.far_mm);
    target_.bind();
    draw(visible);
    Image image = target_.read();
    if (glGetError() != GL_NO_ERROR) throw std::runtime_error("OpenGL cannot draw the bone");
    return image;
  }

 private:
  // Draws these bricks in order, skipping those already hidden; returns the bricks drawn.
  std::vector<std::size_t> draw(const std::vector<std::size_t>& bricks) {
    const DensityView view(bone_);
    std::vector<std::size_t> drawn;
    std::size_t done = 0;
    DepthTiles depths(target_, projection_, scene_.camera);
    const auto flush = [&] {
      layer_.draw(scene_, projection_, cavities_, layer_.visible_bricks(scene_, projection_, kFullDetail));
      for (; done < drawn.size(); ++done) layer_.set_brick(drawn[done], {});
      depths = DepthTiles(target_, projection_, scene_.camera);
    };
    std::size_t triangles = 0;
    for (const std::size_t brick : bricks) {
      if (depths.is_hidden(layer_.bounds(brick))) continue;
      BrickMesh mesh = mesh_brick(view, brick);
      if (mesh.empty()) continue;
      for (MeshVertex& vertex : mesh.vertices) deepen_density(bone_, vertex);
      drawn.push_back(brick);
      triangles += mesh.triangle_count();
      layer_.set_brick(brick, full_detail(std::move(mesh)));
      if (triangles < kTrianglesAtOnce) continue;
      flush();
      triangles = 0;
    }
    flush();
    return drawn;
  }

  const Volume& bone_;
  const ViewScene& scene_;
  Projection projection_;
  BoneLayer layer_;
  FrameTarget target_;
  CavityPass cavities_;
};

Camera camera_at(const Volume& bone, const Vec3& entry_W, const Vec3& direction_W, const Vec3& up_W) {
  Camera camera = camera_on({entry_W, 1}, direction_W, up_W);
  double height_mm = std::max(kAroundEntry_mm, kAroundEntry_voxels * bone.geometry().spacing_mm.maxCoeff());
  const Extent extent = extent_of_bone(bone, camera);
  if (extent.size_mm < kMaxWhole_mm) {
    camera.focus_W = extent.centre_W;
    height_mm = (1 + 2 * kMargin) * extent.size_mm;
  }
  camera.field_of_view_rad = kFieldOfView_rad;
  camera.distance_mm = 0.5 * height_mm / std::tan(0.5 * kFieldOfView_rad);
  return camera;
}

}  // namespace

Camera camera_above(const Volume& bone, const Vec3& entry_W, const Vec3& into_W, const Vec3& lateral_W) {
  // Steep enough to look into a hole as deep as it is wide.
  return camera_at(bone, entry_W, 0.8 * into_W + 0.5 * into_W.cross(lateral_W) + 0.25 * lateral_W, -into_W);
}

Camera camera_along(const Volume& bone, const Vec3& entry_W, const Vec3& into_W, const Vec3& lateral_W) {
  return camera_at(bone, entry_W, into_W, lateral_W);
}

Image bone_picture(const Volume& bone, double reference_density, const Camera& camera, const PixelSize& size,
                   bool of_patient) {
  const OffscreenContext context;
  const ViewScene scene = scene_with(bone, reference_density, camera);
  BonePainter painter(bone, scene, {kSupersampling * size.width, kSupersampling * size.height});
  Image image = averaged_down(painter.paint(), kSupersampling);
  const double scale = std::max(1.0, size.height / kAnnotatedHeight_px);
  annotate(image, camera, of_patient, kInkOnLight, scale);
  return image;
}

}  // namespace osteomill
