// End-to-end test of line-proxy's intersection point, from the bone through the session to the picture.
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/visual/offscreen_context.h"
#include "osteomill/visual/scene_renderer.h"
#include "osteomill/volume/bone_densities.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

// Bone below z = 0 with an edge along y; the shaft descends on the edge, with the tip beyond it.
ViewScene shaft_on_a_plane() {
  Volume bone = testing_support::shape_volume(testing_support::centred_cube(64, 0.25),
                                              [](const Vec3& p) { return std::max(p.z(), p.x()); });
  const BoneDensities densities = estimate_densities(bone);
  MillingSession session(std::make_shared<Volume>(std::move(bone)), densities,
                         {.algorithm = algorithm_named("line-proxy")});
  PosedDevice device;
  ViewScene scene;
  for (int n = 0; n < 600; ++n) {
    device.put({{10, 0.1, std::max(-0.3, 1 - 0.005 * n)}, smallest_rotation(Vec3::UnitZ(), -Vec3::UnitX())});
    scene.X_WT = session.tick(device, {.time_s = n * 1e-3}).X_WT;
  }
  scene.intersection_W = session.intersection_W();
  EXPECT_TRUE(session.tick(device, {.time_s = 1, .paused = true}).paused);
  EXPECT_FALSE(session.intersection_W());
  return scene;
}

TEST(DrawnIntersection, PictureIsRedWhereShaftMeetsBone) {
  const OffscreenContext context;
  constexpr PixelSize kSize{640, 480};
  ViewScene scene = shaft_on_a_plane();
  ASSERT_TRUE(scene.intersection_W);
  const Vec3 point_W = *scene.intersection_W;
  EXPECT_NEAR(point_W.z(), 0, 0.1);
  const GridGeometry geometry = testing_support::centred_cube(8, 1);
  SceneRenderer renderer(SurfaceBricks(geometry.dims), geometry);
  scene.bounds = {Vec3::Zero(), 20};
  scene.camera = camera_on(scene.bounds, {0.1, -1, 0.2}, Vec3::UnitZ());
  const auto is_red = [&] {
    renderer.draw(scene, kSize);
    const Eigen::Vector2d place = pixel_of(scene.camera, kSize, point_W);
    const Image picture = renderer.picture();
    const unsigned char* rgb = picture.pixel(static_cast<int>(place.x()), static_cast<int>(place.y()));
    return rgb[0] > 100 && rgb[1] < 60 && rgb[2] < 60;
  };
  EXPECT_TRUE(is_red());
  scene.intersection_W.reset();
  EXPECT_FALSE(is_red());
}

}  // namespace
}  // namespace osteomill
