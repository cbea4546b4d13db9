#include "app/simulate/view_aids.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace osteomill::app {

WindowLevel dragged_grey(const WindowLevel& grey, double right_px, double down_px) {
  constexpr double kRate = 1.0 / 500;
  const double window = (grey.white - grey.black) * std::exp(kRate * right_px);
  const double level = 0.5 * (grey.white + grey.black) - kRate * down_px * window;
  return {level - 0.5 * window, level + 0.5 * window};
}

Camera loupe_camera(const Camera& camera, const PixelSize& size, const Vec3& burr_W, const PixelSize& inset,
                    double power) {
  Camera loupe = camera;
  loupe.focus_W = burr_W;
  loupe.distance_mm = depth_of(camera, burr_W);
  loupe.field_of_view_rad =
      2 * std::atan(std::tan(0.5 * camera.field_of_view_rad) * inset.height / (size.height * power));
  return loupe;
}

std::string markups_text(const std::vector<Landmark>& landmarks) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const Landmark& mark : landmarks)
    points.push_back(
        {{"label", mark.name}, {"position", {mark.point_W.x(), mark.point_W.y(), mark.point_W.z()}}});
  const nlohmann::ordered_json markups{
      {"@schema",
       "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
       "markups-schema-v1.0.3.json#"},
      {"markups", nlohmann::ordered_json::array({{{"type", "Fiducial"},
                                                  {"coordinateSystem", "LPS"},
                                                  {"coordinateUnits", "mm"},
                                                  {"controlPoints", points}}})}};
  return markups.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace osteomill::app
