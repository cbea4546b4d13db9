#include "osteomill/visual/bone_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/visual/offscreen_context.h"
#include "osteomill/volume/builtin_tooth.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

constexpr PixelSize kSize{320, 320};

int brightness(const Image& image, int x, int y) {
  return image.pixel(x, y)[0] + image.pixel(x, y)[1] + image.pixel(x, y)[2];
}

bool is_background(const Image& image, int x, int y) {
  return brightness(image, x, y) == 765;
}

// The scale bar is in the lower left corner.
bool in_scale_bar(const Image& image, int x, int y) {
  return x < image.width / 2 && y > image.height - 60;
}

struct CoveredArea {
  int min_x = 1 << 20, max_x = -1, min_y = 1 << 20, max_y = -1;
  int count = 0;
};

CoveredArea covered(const Image& image) {
  CoveredArea all;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (is_background(image, x, y) || in_scale_bar(image, x, y)) continue;
      all.min_x = std::min(all.min_x, x), all.max_x = std::max(all.max_x, x);
      all.min_y = std::min(all.min_y, y), all.max_y = std::max(all.max_y, y);
      ++all.count;
    }
  }
  return all;
}

Image picture_from_above(const Volume& bone, const Camera& camera) {
  return bone_picture(bone, 900, camera, kSize);
}

Camera camera_from_above(const Volume& bone) {
  return camera_above(bone, {0, 0, 2}, -Vec3::UnitZ(), Vec3::UnitX());
}

// The orientation letters are in the lower right corner; otherwise nothing else is drawn.
TEST(BonePicture, DrawsOrientationLettersForPatientsOnly) {
  const Volume bone = shape_volume(centred_cube(72, 0.25), ball(Vec3::Zero(), 5));
  const Camera camera = camera_from_above(bone);
  const Image without = bone_picture(bone, 900, camera, kSize);
  const Image with = bone_picture(bone, 900, camera, kSize, true);
  int in_corner = 0;
  int elsewhere = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const bool corner = x > kSize.width - 130 && y > kSize.height - 130;
      if (brightness(with, x, y) != brightness(without, x, y)) ++(corner ? in_corner : elsewhere);
    }
  }
  EXPECT_GT(in_corner, 200);
  EXPECT_EQ(elsewhere, 0);
}

TEST(BonePicture, BallCoversAreaOfItsDiscAtAnyPosition) {
  for (const Vec3& middle : {Vec3(0.3, -0.2, 0.4), Vec3(2, 2, -2)}) {
    const Volume bone = shape_volume(centred_cube(72, 0.25), ball(middle, 5));
    const Camera camera = camera_from_above(bone);
    const double pixel_mm = mm_per_pixel(camera, kSize, camera.distance_mm);
    // Partly covered pixels count as bone.
    const double radius_mm =
        std::sqrt(covered(picture_from_above(bone, camera)).count / std::numbers::pi) * pixel_mm;
    EXPECT_NEAR(radius_mm, 5, 1.5 * pixel_mm);
  }
}

TEST(BonePicture, SmallBoneFitsInPicture) {
  const Volume tooth(builtin_tooth(0.5), kBuiltinToothIsovalue);
  for (const Vec3& into : {Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(-1, 0, 0)}) {
    const Camera camera = camera_above(tooth, Vec3::Zero(), into, into.unitOrthogonal());
    const CoveredArea all = covered(bone_picture(tooth, 1500, camera, kSize));
    EXPECT_GT(std::min(all.min_x, all.min_y), 3);
    EXPECT_LT(std::max(all.max_x, all.max_y), 316);
    EXPECT_GT(std::max(all.max_x - all.min_x, all.max_y - all.min_y), 200);
  }
}

TEST(BonePicture, LargeBoneIsShownAroundEntry) {
  const Volume bone = shape_volume(centred_cube(100, 0.7), ball(Vec3::Zero(), 33));
  const Vec3 entry_W(0, 0, 33);
  const Camera camera = camera_above(bone, entry_W, -Vec3::UnitZ(), Vec3::UnitX());
  EXPECT_EQ(camera.focus_W, entry_W);
  EXPECT_NEAR(kSize.height * mm_per_pixel(camera, kSize, camera.distance_mm), 24, 1);
  EXPECT_GT(covered(picture_from_above(bone, camera)).count, 320 * 320 / 2);
}

TEST(BonePicture, ScaleHardlyChangesWithDepth) {
  const Volume bone = shape_volume(centred_cube(60, 0.25), ball(Vec3::Zero(), 5));
  const Camera camera = camera_from_above(bone);
  const double at_focus = mm_per_pixel(camera, kSize, camera.distance_mm);
  EXPECT_NEAR(mm_per_pixel(camera, kSize, camera.distance_mm - 10) / at_focus, 1, 0.04);
}

TEST(BonePicture, MilledHoleIsDarkerAndTheRestUnchanged) {
  const auto block = [](double hole_mm) {
    return [hole_mm](const Vec3& p) {
      const double box = (p.cwiseAbs() - Vec3(5, 5, 4)).maxCoeff();
      const double hole = std::max(std::hypot(p.x(), p.y()) - hole_mm, 2.6 - p.z());
      return std::max(box, -hole);
    };
  };
  const Volume before = shape_volume(centred_cube(96, 0.125), block(-1));
  const Volume after = shape_volume(centred_cube(96, 0.125), block(1.3));
  const Camera camera = camera_above(before, {0, 0, 4}, -Vec3::UnitZ(), Vec3::UnitX());
  const Image whole = picture_from_above(before, camera);
  const Image milled = picture_from_above(after, camera);
  const Eigen::Vector2d floor = pixel_of(camera, kSize, Vec3(0, 0, 2.6));
  const int x = static_cast<int>(floor.x());
  const int y = static_cast<int>(floor.y());
  EXPECT_LT(brightness(milled, x, y), 0.8 * brightness(whole, x, y));
  // Radius of the darkening around the hole, px.
  const Eigen::Vector2d middle = pixel_of(camera, kSize, Vec3(0, 0, 4));
  const double reach_px = 1.3 / mm_per_pixel(camera, kSize, camera.distance_mm) + 2.0 * kSize.height / 16;
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      if ((Eigen::Vector2d(u, v) - middle).norm() < reach_px) continue;
      ASSERT_NEAR(brightness(milled, u, v), brightness(whole, u, v), 6) << u << ", " << v;
    }
  }
}

TEST(BonePicture, ShowsOnlyScaleBarWithoutBone) {
  const GridGeometry geometry = centred_cube(20, 0.5);
  const Volume air(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 10.0f)), 500);
  const Image image = picture_from_above(air, camera_from_above(air));
  EXPECT_EQ(covered(image).count, 0);
  int bar = 0;
  for (int x = 0; x < kSize.width; ++x) bar += brightness(image, x, kSize.height - 24) < 3 * 60 ? 1 : 0;
  EXPECT_GT(bar, 20);
  EXPECT_LE(bar, kSize.width / 4 + 4);
}

TEST(BonePicture, ShowsOffsetBallAtUpperRight) {
  const Volume bone = shape_volume(centred_cube(40, 0.25), ball(Vec3(2, 0, 3), 1.2));
  Camera camera = camera_on({Vec3::Zero(), 5}, Vec3::UnitY(), Vec3::UnitZ());
  const CoveredArea all = covered(picture_from_above(bone, camera));
  EXPECT_GT(all.min_x, 160);
  EXPECT_LT(all.max_y, 160);
  EXPECT_GT(all.count, 500);
}

TEST(BonePicture, EnamelIsWhiterThanDentine) {
  const Volume tooth(builtin_tooth(0.5), kBuiltinToothIsovalue);
  const Vec3 middle_W = tooth.geometry().world_from_voxel(
      Vec3(0.5 * Eigen::Map<const Eigen::Array3i>(tooth.geometry().dims.data()).cast<double>()));
  const Camera camera = camera_on({middle_W, 12}, Vec3::UnitY(), Vec3::UnitZ());
  const Image image = bone_picture(tooth, 1500, camera, kSize);
  const auto blue_share = [&](double z_mm) {
    const Eigen::Vector2d pixel = pixel_of(camera, kSize, Vec3(middle_W.x(), middle_W.y(), z_mm));
    const unsigned char* rgb = image.pixel(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    EXPECT_FALSE(is_background(image, static_cast<int>(pixel.x()), static_cast<int>(pixel.y())));
    return static_cast<double>(rgb[2]) / rgb[0];
  };
  EXPECT_GT(blue_share(17), 0.88);
  EXPECT_LT(blue_share(12), 0.8);
}

// Far more triangles than are held in memory at once, nearly all of them behind the first sheet.
TEST(BonePicture, PictureDrawnInPiecesIsComplete) {
  const auto sheets = [](double lowest_z) {
    return [lowest_z](const Vec3& p) {
      const double period = p.z() - 0.8 * std::floor(p.z() / 0.8);
      const double sheet = std::abs(period - 0.4) - 0.15;
      return std::max({sheet, p.cwiseAbs().maxCoeff() - 12, lowest_z - p.z()});
    };
  };
  const Volume one = shape_volume(centred_cube(200, 0.125), sheets(10.4));
  const Volume many = shape_volume(centred_cube(200, 0.125), sheets(-12));
  const Camera camera = camera_on({Vec3(0, 0, 11), 11}, -Vec3::UnitZ(), Vec3::UnitY());
  const Image front = picture_from_above(one, camera);
  const Image all = picture_from_above(many, camera);
  EXPECT_EQ(covered(all).count, covered(front).count);
  int others = 0;
  for (std::size_t n = 0; n < all.rgb.size(); ++n) others += std::abs(all.rgb[n] - front.rgb[n]) > 3 ? 1 : 0;
  EXPECT_LT(others, static_cast<int>(all.rgb.size()) / 200);
}

TEST(BonePicture, ConcurrentThreadsDrawIdenticalPictures) {
  const Volume tooth(builtin_tooth(0.25), kBuiltinToothIsovalue);
  const Camera camera = camera_above(tooth, Vec3::Zero(), -Vec3::UnitZ(), Vec3::UnitX());
  const Image expected = bone_picture(tooth, 1500, camera, kSize);
  std::vector<Image> images(4);
  {
    std::vector<std::jthread> threads;
    for (Image& image : images) {
      threads.emplace_back([&] {
        for (int n = 0; n < 3; ++n) image = bone_picture(tooth, 1500, camera, kSize);
      });
    }
  }
  for (const Image& image : images) EXPECT_EQ(image.rgb, expected.rgb);
}

// In a process of its own, because the libraries read the environment only once.
TEST(OffscreenContextDeathTest, ReportsMissingOpenGl) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto try_without = [](const char* name, const char* value) {
    setenv(name, value, 1);
    try {
      const OffscreenContext context;
    } catch (const std::runtime_error& error) {
      fprintf(stderr, "told: %s", error.what());
      std::_Exit(0);
    }
    std::_Exit(1);
  };
  EXPECT_EXIT(try_without("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null"), testing::ExitedWithCode(0),
              "told: no OpenGL");
  EXPECT_EXIT(try_without("LIBGL_DRIVERS_PATH", "/nowhere"), testing::ExitedWithCode(0), "told: no OpenGL");
}

}  // namespace
}  // namespace osteomill
