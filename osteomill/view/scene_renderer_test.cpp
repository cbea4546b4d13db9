#include "osteomill/view/scene_renderer.h"

#include <cstdlib>
#include <filesystem>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/surface/png.h"
#include "osteomill/surface/surface_mesh.h"
#include "osteomill/view/offscreen_context.h"

namespace osteomill {
namespace {

// A ball of bone with a denser shell on its left half, and a hole from above.
Volume drilled_ball() {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(56, 0.25), [](const Vec3& p) {
    const double ball = p.norm() - 6;
    const double hole = Vec3(p.x(), p.y(), std::max(p.z() - 7, std::min(p.z() - 1.0, 0.0))).norm() - 1.8;
    return std::max(ball, -hole);
  });
  return volume;
}

class SceneRendererTest : public ::testing::Test {
 protected:
  SceneRendererTest() {
    const SurfaceMesh mesh = mesh_surface(DensityView(bone_));
    renderer_ = std::make_unique<SceneRenderer>(mesh.layout, bone_.geometry());
    for (std::size_t n = 0; n < mesh.bricks.size(); ++n) renderer_->set_brick(n, mesh.bricks[n]);
    scene_.bounds = {Vec3::Zero(), 7};
    scene_.camera = camera_on(scene_.bounds, {0.3, 1, -0.9}, Vec3::UnitZ());
    scene_.isovalue = bone_.isovalue();
    scene_.reference_density = 900;
  }

  Image drawn() {
    renderer_->draw(scene_, kSize);
    renderer_->draw(scene_, kSize);
    const char* keep = std::getenv("OSTEOMILL_PICTURES");
    Image image = renderer_->picture();
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    if (keep != nullptr) write_png(std::filesystem::path(keep) / (std::string(test->name()) + ".png"), image);
    return image;
  }

  static constexpr PixelSize kSize{320, 240};
  OffscreenContext context_;
  Volume bone_ = drilled_ball();
  std::unique_ptr<SceneRenderer> renderer_;
  ViewScene scene_;
};

TEST_F(SceneRendererTest, Bone) {
  drawn();
}

TEST_F(SceneRendererTest, ToolGhostAndArrows) {
  scene_.X_WT = Pose{{0.5, -1.5, 7.2}, quaternion_from_rotation_vector({0.4, 0.3, 0})};
  scene_.X_WD = Pose{{0.5, -1.5, 5.2}, quaternion_from_rotation_vector({0.4, 0.3, 0})};
  scene_.wrench = {{0.2, -0.3, 1.5}, {6, 5, 0}};
  drawn();
}

TEST_F(SceneRendererTest, Cut) {
  scene_.cuts[0] = CutPlane{{0, 1, 0}, 0};
  drawn();
}

}  // namespace
}  // namespace osteomill
