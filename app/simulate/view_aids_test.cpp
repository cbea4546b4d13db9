#include "app/simulate/view_aids.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace osteomill::app {
namespace {

TEST(DraggedGrey, WidensToTheRightAndLightensDownwards) {
  const WindowLevel first{0, 100};
  const WindowLevel wide = dragged_grey(first, 500, 0);
  EXPECT_NEAR(wide.white - wide.black, 100 * std::exp(1), 1e-9);
  EXPECT_NEAR(wide.white + wide.black, 100, 1e-9);
  const WindowLevel light = dragged_grey(first, 0, 250);
  EXPECT_NEAR(light.white - light.black, 100, 1e-9);
  EXPECT_NEAR(0.5 * (light.white + light.black), 0, 1e-9);
}

TEST(LoupeCamera, CentresTheBurrAndMagnifiesByItsPower) {
  Camera camera;
  camera.focus_W = {1, 2, 3};
  camera.orientation = quaternion_from_rotation_vector({0.3, -0.5, 0.2});
  const PixelSize size{1280, 800}, inset{230, 230};
  const Vec3 burr_W(6, -4, 9);
  const Camera loupe = loupe_camera(camera, size, burr_W, inset, 3);
  EXPECT_TRUE(pixel_of(loupe, inset, burr_W).isApprox(Eigen::Vector2d(115, 115), 1e-9));
  EXPECT_NEAR(3 * mm_per_pixel(loupe, inset, depth_of(loupe, burr_W)),
              mm_per_pixel(camera, size, depth_of(camera, burr_W)), 1e-12);
}

TEST(MarkupsText, IsValidJsonWithNamesAndPositions) {
  const auto read =
      nlohmann::json::parse(markups_text({{"a \"quoted\" ü", {1.5, -2, 3}}, {"P2", {0, 0, 4}}}));
  const auto& markups = read.at("markups").at(0);
  EXPECT_EQ(markups.at("coordinateSystem"), "LPS");
  EXPECT_EQ(markups.at("controlPoints").at(0).at("label"), "a \"quoted\" ü");
  EXPECT_EQ(markups.at("controlPoints").at(0).at("position"), nlohmann::json({1.5, -2.0, 3.0}));
  EXPECT_EQ(markups.at("controlPoints").size(), 2u);
}

}  // namespace
}  // namespace osteomill::app
