#include "osteomill/visual/scene_renderer.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "osteomill/visual/image.h"
#include "osteomill/visual/offscreen_context.h"
#include "osteomill/visual/surface_mesh.h"

#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"
#include "view/bone_ground.h"
#include "view/tool_passes.h"

namespace osteomill {
namespace {

using testing_support::mesh_surface;
using testing_support::SurfaceMesh;

// A ball of bone with a denser shell on its left half, and a hole from above.
Volume drilled_ball() {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(56, 0.25), [](const Vec3& p) {
    const double ball = p.norm() - 6;
    const double hole = Vec3(p.x(), p.y(), std::max(p.z() - 7, std::min(p.z() - 1.0, 0.0))).norm() - 1.8;
    return std::max(ball, -hole);
  });
  return volume;
}

// Drivers, and versions of them, round edges differently: most pixels may differ by a few shades at most, and
// no more than one in a hundred by more than kShades.
constexpr int kShades = 12;
constexpr double kOthers = 0.01;
constexpr double kMeanShades = 1.0;

class SceneRendererTest : public ::testing::Test {
 protected:
  SceneRendererTest() {
    const SurfaceMesh mesh = mesh_surface(DensityView(bone_));
    renderer_ = std::make_unique<SceneRenderer>(mesh.layout, bone_.geometry());
    for (std::size_t n = 0; n < mesh.bricks.size(); ++n) set_brick(n, mesh.bricks[n]);
    scene_.bounds = {Vec3::Zero(), 7};
    scene_.camera = camera_on(scene_.bounds, {0.3, 1, -0.9}, Vec3::UnitZ());
    scene_.isovalue = bone_.isovalue();
    scene_.reference_density = 900;
  }

  void set_brick(std::size_t n, const BrickMesh& mesh) { renderer_->set_brick(n, full_detail(mesh)); }

  // Compares the picture with the reference stored under this test's name. With OSTEOMILL_KEEP_PICTURES,
  // replaces the reference.
  void expect_as_kept() {
    renderer_->draw(scene_, kSize);
    renderer_->draw(scene_, kSize);
    const Image drawn = renderer_->picture();
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path kept =
        std::filesystem::path(OSTEOMILL_KEPT_PICTURES) / (std::string(test->name()) + ".png");
    if (std::getenv("OSTEOMILL_KEEP_PICTURES") != nullptr) write_png(kept, drawn);
    std::ifstream file(kept, std::ios::binary);
    const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), {}};
    const Image expected = decode_png(bytes).value_or(Image{});
    ASSERT_EQ(expected.rgb.size(), drawn.rgb.size());
    double sum = 0;
    std::size_t others = 0;
    for (std::size_t n = 0; n < drawn.rgb.size(); ++n) {
      const int difference = std::abs(int(drawn.rgb[n]) - int(expected.rgb[n]));
      sum += difference;
      others += difference > kShades ? 1 : 0;
    }
    const auto count = static_cast<double>(drawn.rgb.size());
    EXPECT_LE(static_cast<double>(others) / count, kOthers);
    EXPECT_LE(sum / count, kMeanShades);
    // Guards against a tolerance that would accept the bare background.
    EXPECT_GT(covered(drawn), 0.1);
  }

  // Returns the fraction of pixels brighter than the background.
  static double covered(const Image& image) {
    std::size_t bright = 0;
    for (std::size_t n = 0; n < image.rgb.size(); n += 3) bright += image.rgb[n] > 75 ? 1 : 0;
    return 3 * static_cast<double>(bright) / static_cast<double>(image.rgb.size());
  }

  Image picture() {
    renderer_->draw(scene_, kSize);
    renderer_->draw(scene_, kSize);
    return renderer_->picture();
  }

  static constexpr PixelSize kSize{320, 240};
  OffscreenContext context_;
  Volume bone_ = drilled_ball();
  std::unique_ptr<SceneRenderer> renderer_;
  ViewScene scene_;
};

TEST_F(SceneRendererTest, Bone) {
  expect_as_kept();
}

TEST_F(SceneRendererTest, ToolGhostAndArrows) {
  scene_.camera = camera_on({Vec3(0, 0, 4), 12}, {0.3, 1, -0.5}, Vec3::UnitZ());
  scene_.X_WT = Pose{{0.5, -3.5, 6.2}, quaternion_from_rotation_vector({0.4, 0.3, 0})};
  scene_.X_WD = Pose{{0.5, -2.8, 4.9}, quaternion_from_rotation_vector({0.4, 0.3, 0})};
  scene_.wrench = {{0.2, -0.9, 1.5}, {12, 9, 0}};
  expect_as_kept();
}

TEST_F(SceneRendererTest, CutWithItsGreys) {
  scene_.cuts[0] = ClipPlane{{0, 1, 0}, 0};
  renderer_->set_clip_face(0, clip_face(bone_.grid(), *scene_.cuts[0], {-100, 1300}));
  expect_as_kept();
}

// A pixel shows the point predicted by the projection.
TEST_F(SceneRendererTest, DrawsToolWhereCameraProjectsIt) {
  const Image without = picture();
  scene_.X_WT = Pose{{2, -7, 6}, Quat::Identity()};
  const Image with = picture();
  const Eigen::Vector2d burr = pixel_of(scene_.camera, kSize, scene_.X_WT->position_mm);
  const int x = static_cast<int>(burr.x());
  const int y = static_cast<int>(burr.y());
  EXPECT_NE(std::vector<int>(with.pixel(x, y), with.pixel(x, y) + 3),
            std::vector<int>(without.pixel(x, y), without.pixel(x, y) + 3));
  const double radius_px =
      scene_.tool.burr_radius_mm /
      mm_per_pixel(scene_.camera, kSize, depth_of(scene_.camera, scene_.X_WT->position_mm));
  const int beside = static_cast<int>(burr.x() + 1.3 * radius_px);
  EXPECT_EQ(std::vector<int>(with.pixel(beside, y), with.pixel(beside, y) + 3),
            std::vector<int>(without.pixel(beside, y), without.pixel(beside, y) + 3));
}

// The tool over a level plane of bone: each pixel beside the tool must be darkened, relative to a picture
// without it, as predicted for the point of the plane behind that pixel.
TEST(ContactShadow, DarkensPlaneAsPredictedFromHiddenSky) {
  const OffscreenContext context;
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(64, 0.5),
                                                    testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const SurfaceMesh mesh = mesh_surface(DensityView(bone));
  SceneRenderer renderer(mesh.layout, bone.geometry());
  for (std::size_t n = 0; n < mesh.bricks.size(); ++n) renderer.set_brick(n, full_detail(mesh.bricks[n]));
  ViewScene scene;
  scene.bounds = {Vec3::Zero(), 14};
  scene.camera = camera_on({Vec3::Zero(), 6}, {0.2, 1, -1.3}, Vec3::UnitZ());
  scene.isovalue = bone.isovalue();
  scene.reference_density = 900;
  const auto picture = [&](const std::optional<Pose>& X_WT) {
    scene.X_WT = X_WT;
    do renderer.draw(scene, kSize);
    while (!renderer.is_settled());
    return renderer.picture();
  };
  const Image without = picture(std::nullopt);
  const double r = scene.tool.burr_radius_mm;
  const Pose touching{{0.3, -0.2, r + 0.1}, Quat::Identity()};
  const Image with = picture(touching);
  const auto brightness = [](const Image& image, int x, int y) {
    return double(image.pixel(x, y)[0] + image.pixel(x, y)[1] + image.pixel(x, y)[2]);
  };
  // Fraction of light that the upright tool leaves at a point of the plane, as documented for ContactShadow.
  const auto light = [&](const Vec3& p) {
    const auto part = [](double distance, double height, double radius, double power) {
      const double radii = distance / radius;
      const double fade = std::clamp((2.5 - radii) / 1.5, 0.0, 1.0);
      const double hidden = height / distance * std::min(std::pow(radii, -power), 1.0) * fade * fade;
      return 1 - ContactShadow::kDarkest * hidden;
    };
    // The shaft axis is nearest to the plane at its lower end, the burr's centre.
    const double height = touching.position_mm.z(), distance = (touching.position_mm - p).norm();
    return part(distance, height, r, 2) * part(distance, height, scene.tool.shaft_radius_mm, 1);
  };
  int dark = 0, unchanged = 0;
  double worst = 0;
  for (int y = 0; y < kSize.height; y += 3) {
    for (int x = 0; x < kSize.width; x += 3) {
      const Vec3 ray = ray_through(scene.camera, kSize, x + 0.5, y + 0.5);
      const Vec3 eye = scene.camera.eye_W();
      const Vec3 p = eye - eye.z() / ray.z() * ray;
      if (p.head<2>().cwiseAbs().maxCoeff() > 12) continue;
      // Skip points hidden by the tool, with a margin for its outline.
      bool free = true;
      for (double t = 0; t < 1; t += 0.002) {
        const Vec3 on_sight = eye + t * (p - eye);
        free = free && tool_distance(scene.tool, touching.inverse() * on_sight).distance_mm > 0.1;
      }
      if (!free) continue;
      const double expected = light(p);
      worst = std::max(worst, std::abs(brightness(with, x, y) / brightness(without, x, y) - expected));
      dark += expected < 0.75 ? 1 : 0;
      unchanged += expected == 1.0 ? 1 : 0;
    }
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_GT(dark, 10);
  EXPECT_GT(unchanged, 1000);
}

TEST_F(SceneRendererTest, DistantToolCastsNoShadowOnBone) {
  const Image without = picture();
  scene_.X_WT = Pose{{0, -9, 12}, Quat::Identity()};
  const Image with = picture();
  // Bone pixels in the lower half; the tool's picture is in the upper half.
  std::size_t others = 0, bone = 0;
  for (std::size_t n = with.rgb.size() / 2; n < with.rgb.size(); ++n) {
    bone += without.rgb[n] > 75 ? 1 : 0;
    others += with.rgb[n] != without.rgb[n] ? 1 : 0;
  }
  EXPECT_GT(bone, 10'000u);
  EXPECT_EQ(others, 0u);
}

TEST_F(SceneRendererTest, BurrBehindBoneIsVisibleOnlyInSeeThroughMode) {
  const Vec3 sight = (scene_.bounds.centre_W - scene_.camera.eye_W()).normalized();
  const Image without = picture();
  // Behind the ball, with the shaft away from the eye.
  scene_.X_WT = Pose{7.7 * sight, smallest_rotation(Vec3::UnitZ(), sight)};
  const Image hidden = picture();
  EXPECT_EQ(hidden.rgb, without.rgb);
  scene_.see_through = true;
  const Image through = picture();
  const Eigen::Vector2d burr = pixel_of(scene_.camera, kSize, scene_.X_WT->position_mm);
  const double radius_px =
      scene_.tool.burr_radius_mm /
      mm_per_pixel(scene_.camera, kSize, depth_of(scene_.camera, scene_.X_WT->position_mm));
  int inside = 0, outside = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const double away_px = (Eigen::Vector2d(x + 0.5, y + 0.5) - burr).norm();
      int change = 0;
      for (int c = 0; c < 3; ++c)
        change = std::max(change, std::abs(int(through.pixel(x, y)[c]) - int(without.pixel(x, y)[c])));
      if (away_px < 0.9 * radius_px) inside += change > 4 ? 1 : 0;
      if (away_px > 1.1 * radius_px) outside += change > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 0.9 * std::numbers::pi * 0.81 * radius_px * radius_px);
  EXPECT_EQ(outside, 0);
  // The burr is golden: its blue-to-red ratio is lower than the bone's.
  const unsigned char* at_burr = through.pixel(static_cast<int>(burr.x()), static_cast<int>(burr.y()));
  const unsigned char* bone = without.pixel(static_cast<int>(burr.x()), static_cast<int>(burr.y()));
  EXPECT_LT(double(at_burr[2]) / at_burr[0], double(bone[2]) / bone[0]);
}

// The bone is not redrawn in every frame, but milled bone must be visible within two frames.
TEST_F(SceneRendererTest, ShowsMilledBricksWhileViewIsStill) {
  for (int n = 0; n < 10; ++n) renderer_->draw(scene_, kSize);
  const double all = covered(renderer_->picture());
  const std::size_t bricks = SurfaceBricks(bone_.geometry().dims).count();
  for (std::size_t n = 0; n < bricks; ++n) set_brick(n, {});
  EXPECT_LT(covered(picture()), 0.1 * all);
}

// If bone is milled while the view rests, only that part of the picture is redrawn.
TEST_F(SceneRendererTest, PartialRedrawMatchesFullRedraw) {
  scene_.camera = camera_on({Vec3(0, 0, 4), 9}, {0.3, 1, -0.5}, Vec3::UnitZ());
  while (!renderer_->is_settled()) renderer_->draw(scene_, kSize);
  const Image before = renderer_->picture();
  Volume milled = bone_;
  const GridGeometry& geometry = milled.geometry();
  for (int k = 0; k < geometry.dims[2]; ++k)
    for (int j = 0; j < geometry.dims[1]; ++j)
      for (int i = 0; i < geometry.dims[0]; ++i)
        if ((geometry.world_from_voxel(VoxelIndex{i, j, k}) - Vec3(2, -4, 4)).norm() < 1.5)
          milled.lower_density({i, j, k}, 0);
  const SurfaceMesh mesh = mesh_surface(DensityView(milled));
  const SurfaceMesh old = mesh_surface(DensityView(bone_));
  for (std::size_t n = 0; n < mesh.bricks.size(); ++n) {
    if (mesh.bricks[n] != old.bricks[n]) set_brick(n, mesh.bricks[n]);
  }
  EXPECT_FALSE(renderer_->is_settled());
  for (int n = 0; n < 10; ++n) renderer_->draw(scene_, kSize);
  const Image pieces = renderer_->picture();
  // A change of view in between forces a full redraw.
  const Camera camera = scene_.camera;
  turn(scene_.camera, kSize, 20, 5);
  renderer_->draw(scene_, kSize);
  scene_.camera = camera;
  renderer_->draw(scene_, kSize);
  while (!renderer_->is_settled()) renderer_->draw(scene_, kSize);
  const Image whole = renderer_->picture();
  std::size_t milled_away = 0;
  std::size_t others = 0;
  for (std::size_t n = 0; n < whole.rgb.size(); ++n) {
    milled_away += std::abs(int(whole.rgb[n]) - int(before.rgb[n])) > kShades ? 1 : 0;
    others += std::abs(int(whole.rgb[n]) - int(pieces.rgb[n])) > kShades ? 1 : 0;
  }
  EXPECT_GT(milled_away, 1000u);
  EXPECT_LT(others, milled_away / 20);
}

// While the view moves, pictures with fewer triangles look much like those in full detail.
TEST_F(SceneRendererTest, CoarserLevelsLookNearlyTheSame) {
  scene_.camera.distance_mm *= 9;
  while (!renderer_->is_settled()) renderer_->draw(scene_, kSize);
  const Image all = renderer_->picture();
  const SurfaceMesh mesh = mesh_surface(DensityView(bone_));
  for (std::size_t n = 0; n < mesh.bricks.size(); ++n) {
    BrickLevels levels = build_levels(mesh.bricks[n], bone_.geometry(), mesh.layout.cells(n));
    levels.levels[0] = levels.levels[1 + n % 3];
    renderer_->set_brick(n, levels);
  }
  const Image fewer = picture();
  double sum = 0;
  for (std::size_t n = 0; n < all.rgb.size(); ++n) sum += std::abs(int(all.rgb[n]) - int(fewer.rgb[n]));
  EXPECT_GT(sum, 0);
  EXPECT_LT(sum / static_cast<double>(all.rgb.size()), 1.5);
}

TEST(FrameBudget, ShrinksIfDrawingIsSlowAndGrowsIfFast) {
  FrameBudget pace(20'000, 150'000);
  const std::size_t first = pace.budget();
  for (int n = 0; n < 20; ++n) pace.record_draw(pace.budget(), 2e-6 * static_cast<double>(pace.budget()));
  EXPECT_LT(pace.budget(), first / 2);
  EXPECT_GE(pace.budget(), 20'000u);
  for (int n = 0; n < 60; ++n) pace.record_draw(pace.budget(), 1e-8 * static_cast<double>(pace.budget()));
  EXPECT_NEAR(static_cast<double>(pace.budget()), FrameBudget::kBone_s / 1e-8, 2e5);
}

TEST(FrameBudget, OneDelayedFrameReducesBudgetByLessThanHalf) {
  FrameBudget pace(20'000, 150'000);
  const std::size_t first = pace.budget();
  pace.record_draw(pace.budget(), 1.0);
  EXPECT_GT(pace.budget(), first / 2);
}

TEST(FrameBudget, ClampsPixelsToMinimumIfSlowAndGrowsIfFast) {
  FrameBudget pace(500'000, 2'000'000);
  EXPECT_GT(pace.budget(), 1'500'000u);
  for (int n = 0; n < 20; ++n) pace.record_draw(1'000'000, 0.1);
  EXPECT_EQ(pace.budget(), 500'000u);
  for (int n = 0; n < 20; ++n) pace.record_draw(8'000'000, 0.01);
  EXPECT_GT(pace.budget(), 8'000'000u);
}

// The first frame uses the initial estimate of the pace.
TEST_F(SceneRendererTest, DrawsLargePictureAtHalfSizeUntilItRests) {
  constexpr PixelSize kLarge{1920, 1080};
  renderer_->draw(scene_, kLarge);
  const Image moving = renderer_->picture();
  EXPECT_EQ(moving.width, 960);
  EXPECT_EQ(moving.height, 540);
  do {
    renderer_->draw(scene_, kLarge);
  } while (!renderer_->is_settled());
  const Image rested = renderer_->picture();
  EXPECT_EQ(rested.width, 1920);
  EXPECT_EQ(rested.height, 1080);
  EXPECT_NEAR(covered(moving), covered(rested), 0.005);
}

TEST_F(SceneRendererTest, ShadingOfMovingViewMatchesRestingView) {
  const double last_mm = scene_.camera.distance_mm;
  for (const double times : {0.5, 0.5, 0.998, 1.0}) {
    scene_.camera.distance_mm = times * last_mm;
    renderer_->draw(scene_, kSize);
  }
  const Image moving = renderer_->picture();
  do {
    renderer_->draw(scene_, kSize);
  } while (!renderer_->is_settled());
  const Image rested = renderer_->picture();
  double sum = 0;
  for (std::size_t n = 0; n < moving.rgb.size(); ++n)
    sum += std::abs(int(moving.rgb[n]) - int(rested.rgb[n]));
  EXPECT_LT(sum / static_cast<double>(moving.rgb.size()), 2 * kMeanShades);
}

TEST_F(SceneRendererTest, RemovedBricksDisappear) {
  const double all = covered(picture());
  EXPECT_GT(renderer_->triangle_count(), 1000u);
  for (std::size_t n = 0; n < SurfaceBricks(bone_.geometry().dims).count(); ++n) set_brick(n, {});
  EXPECT_EQ(renderer_->triangle_count(), 0u);
  EXPECT_LT(covered(picture()), 0.1 * all);
}

// Returns the sum over all pixels of the first channel minus the third.
double redness(const Image& image) {
  double sum = 0;
  for (std::size_t n = 0; n < image.rgb.size(); n += 3) sum += int(image.rgb[n]) - int(image.rgb[n + 2]);
  return sum / static_cast<double>(image.rgb.size() / 3);
}

TEST_F(SceneRendererTest, ColoursBoneByLabelsIfShown) {
  const double without = redness(picture());
  const GridGeometry& geometry = bone_.geometry();
  const auto labels =
      std::make_shared<const LabelMap>(std::vector<Label>{{1, "blue", {0, 0, 255}}}, geometry, geometry,
                                       std::vector<LabelMap::LabelIndex>(geometry.voxel_count(), 1));
  const SurfaceMesh mesh = mesh_surface(DensityView(bone_));
  renderer_ = std::make_unique<SceneRenderer>(mesh.layout, geometry, labels);
  for (std::size_t n = 0; n < mesh.bricks.size(); ++n) set_brick(n, mesh.bricks[n]);
  EXPECT_LT(redness(picture()), without - 20);
  scene_.show_labels = false;
  EXPECT_NEAR(redness(picture()), without, 0.01);
}

}  // namespace
}  // namespace osteomill
