#include "osteomill/surface/isosurface_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/surface/isosurface_ray.h"
#include "osteomill/volume/builtin_tooth.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

int brightness(const Image& image, int x, int y) {
  return image.pixel(x, y)[0] + image.pixel(x, y)[1] + image.pixel(x, y)[2];
}

// Area of all that is not background, mm^2.
double silhouette_mm2(const Image& image, double width_mm) {
  std::size_t pixels = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) pixels += brightness(image, x, y) < 765 ? 1 : 0;
  }
  const double mm_per_pixel = width_mm / image.width;
  return static_cast<double>(pixels) * mm_per_pixel * mm_per_pixel;
}

TEST(BoneRays, MeetABallWhereGeometrySays) {
  GridGeometry geometry = centred_cube(60, 0.2);
  geometry.spacing_mm = Vec3(0.2, 0.25, 0.3);
  geometry.direction = Quat(0.8, 0.3, -0.4, 0.33).normalized().toRotationMatrix();
  geometry.origin_mm = -geometry.direction * Vec3(0.5 * 59 * 0.2, 0.5 * 59 * 0.25, 0.5 * 59 * 0.3);
  const Volume volume = shape_volume(geometry, ball(Vec3::Zero(), 4));
  const BoneRays rays(volume);
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(-1, 2, 0.5), Vec3(0.3, 0.2, -1)}) {
    const Vec3 along = direction.normalized();
    const Vec3 aside = along.unitOrthogonal();
    for (const double offset_mm : {0.0, 1.0, 3.0, 3.9}) {
      const auto hit = rays.first_on_line(7 * along + offset_mm * aside, along);
      ASSERT_TRUE(hit) << offset_mm;
      const Vec3 expected = offset_mm * aside - std::sqrt(16 - offset_mm * offset_mm) * along;
      EXPECT_LT((hit->point_W - expected).norm(), offset_mm < 3.5 ? 0.03 : 0.15);
      EXPECT_GT(hit->normal_W.dot(expected.normalized()), std::cos(2 * std::numbers::pi / 180));
    }
    EXPECT_FALSE(rays.first_on_line(4.1 * aside, along));
  }
}

TEST(BoneRays, MeetTheCutFaceWhereBoneReachesTheBorder) {
  const Volume volume = shape_volume(centred_cube(20, 0.5), plane(Vec3::Zero(), Vec3::UnitX()));
  const auto hit = BoneRays(volume).first_on_line({-2, 1, 0}, -Vec3::UnitZ());
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point_W.z(), 4.75, 1e-9);
  EXPECT_EQ(hit->normal_W, Vec3::UnitZ());
}

TEST(IsosurfacePicture, ABallHasTheAreaOfItsDisc) {
  const Volume volume = shape_volume(centred_cube(64, 0.25), ball(Vec3(0.3, -0.2, 0.4), 5));
  for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(1, 2, -0.5)}) {
    PictureView view;
    view.direction_W = direction;
    view.up_W = Vec3(0.3, 1, 0.2);
    view.width_mm = 16;
    view.width_pixels = 800;
    view.height_pixels = 600;
    EXPECT_NEAR(silhouette_mm2(isosurface_picture(volume, view), 16) / (std::numbers::pi * 25), 1, 0.01);
  }
}

TEST(IsosurfacePicture, WithoutBoneAllIsBackground) {
  const GridGeometry geometry = centred_cube(20, 0.5);
  const Volume volume(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 10.0f)), 500);
  const Image image = isosurface_picture(volume, view_of_bone(volume, Vec3::UnitX(), Vec3::UnitZ(), 60, 40));
  EXPECT_EQ(image.width, 60);
  EXPECT_EQ(image.height, 40);
  EXPECT_EQ(image.rgb, std::vector<unsigned char>(3 * 60 * 40, 255));
}

TEST(IsosurfacePicture, PutsRightAndUpWhereTheyBelong) {
  // Looking along +y with z up, +x is to the right.
  const Volume volume = shape_volume(centred_cube(40, 0.25), ball(Vec3(2, 0, 3), 1.2));
  PictureView view;
  view.direction_W = Vec3::UnitY();
  view.up_W = Vec3::UnitZ();
  view.width_mm = 10;
  view.width_pixels = view.height_pixels = 100;
  const Image image = isosurface_picture(volume, view);
  EXPECT_LT(image.pixel(70, 20)[2], 240);
  EXPECT_EQ(brightness(image, 30, 20), 765);
  EXPECT_EQ(brightness(image, 70, 80), 765);
}

TEST(IsosurfacePicture, AHoleIsDarkerThanTheFaceAroundIt) {
  const auto drilled_face = [](const Vec3& p) {
    const double cylinder = std::hypot(p.x(), p.y()) - 1.0;
    return std::max(p.z() - 2, std::min(-cylinder, p.z() + 1.5));
  };
  const Volume volume = shape_volume(centred_cube(60, 0.15), drilled_face);
  PictureView view;
  view.width_mm = 8;
  view.width_pixels = view.height_pixels = 160;
  const Image image = isosurface_picture(volume, view);
  EXPECT_LT(brightness(image, 80, 80), 0.75 * brightness(image, 30, 30));
}

TEST(IsosurfacePicture, EnamelIsWhiterThanDentine) {
  const Volume volume(builtin_tooth(0.5), kBuiltinToothIsovalue);
  PictureView view = view_of_bone(volume, Vec3::UnitY(), Vec3::UnitZ(), 120, 200);
  const Image image = isosurface_picture(volume, view);
  const auto blue_share = [&](double z_mm) {
    const int y = static_cast<int>(100 - (z_mm - view.centre_W.z()) / view.width_mm * 120);
    return static_cast<double>(image.pixel(60, y)[2]) / image.pixel(60, y)[0];
  };
  EXPECT_GT(blue_share(17), 0.88);
  EXPECT_LT(blue_share(12), 0.8);
}

TEST(IsosurfacePicture, TheViewOfTheBoneHoldsAllOfIt) {
  const Volume volume(builtin_tooth(0.5), kBuiltinToothIsovalue);
  for (const Vec3& direction : {Vec3(0, 1, 0), Vec3(0.4, -0.5, -0.8)}) {
    const Image image = isosurface_picture(volume, view_of_bone(volume, direction, Vec3::UnitZ(), 90, 120));
    int least_x = 90, greatest_x = 0, least_y = 120, greatest_y = 0;
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 90; ++x) {
        if (brightness(image, x, y) == 765) continue;
        least_x = std::min(least_x, x), greatest_x = std::max(greatest_x, x);
        least_y = std::min(least_y, y), greatest_y = std::max(greatest_y, y);
      }
    EXPECT_GT(least_x, 2);
    EXPECT_LT(greatest_x, 87);
    EXPECT_GT(least_y, 2);
    EXPECT_LT(greatest_y, 117);
    EXPECT_GT(std::max((greatest_x - least_x) / 90.0, (greatest_y - least_y) / 120.0), 0.6);
  }
}

TEST(IsosurfacePicture, IsTheSameEveryTime) {
  const Volume volume(builtin_tooth(0.25), kBuiltinToothIsovalue);
  const PictureView view = view_of_bone(volume, Vec3(1, 1, -1), Vec3::UnitZ(), 80, 80);
  EXPECT_EQ(isosurface_picture(volume, view).rgb, isosurface_picture(volume, view).rgb);
}

TEST(IsosurfacePicture, RefusesAViewThatMakesNoSense) {
  const Volume volume = shape_volume(centred_cube(10, 1), ball(Vec3::Zero(), 3));
  PictureView view;
  view.up_W = -view.direction_W;
  EXPECT_THROW(isosurface_picture(volume, view), std::invalid_argument);
  view = {};
  view.width_mm = 0;
  EXPECT_THROW(isosurface_picture(volume, view), std::invalid_argument);
  view = {};
  view.height_pixels = 0;
  EXPECT_THROW(isosurface_picture(volume, view), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
