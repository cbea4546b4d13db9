#pragma once

#include <string>
#include <vector>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/clip_face.h"

namespace osteomill::app {

/// A point of bone that was marked.
struct Landmark {
  std::string name;
  Vec3 point_W;
};
/// Returns how far apart two are, mm.
inline double distance_mm(const Landmark& a, const Landmark& b) {
  return (a.point_W - b.point_W).norm();
}

/// Returns the window and level after a drag, as 3D Slicer has it: to the right for less contrast, down for
/// lighter greys. A drag by 500 pixels changes the contrast by e.
WindowLevel dragged_grey(const WindowLevel& grey, double right_px, double down_px);

/// Returns the camera of the loupe: the burr in the middle of a picture of `inset`, `power` times as large as
/// in the view.
Camera loupe_camera(const Camera& camera, const PixelSize& size, const Vec3& burr_W, const PixelSize& inset,
                    double power);

/// Returns the landmarks as a file of 3D Slicer's (.mrk.json), in LPS and mm.
std::string markups_text(const std::vector<Landmark>& landmarks);

}  // namespace osteomill::app
