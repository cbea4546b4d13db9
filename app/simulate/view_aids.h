#pragma once

#include <string>
#include <vector>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/clip_face.h"

namespace osteomill::app {

/// A marked point of the bone.
struct Landmark {
  std::string name;
  Vec3 point_W;
};
/// Returns the distance between two landmarks, mm.
inline double distance_mm(const Landmark& a, const Landmark& b) {
  return (a.point_W - b.point_W).norm();
}

/// Returns window and level after a drag, as in 3D Slicer: right lowers the contrast, down makes the picture
/// lighter. A drag of 500 pixels changes the contrast by a factor of e.
WindowLevel dragged_grey(const WindowLevel& grey, double right_px, double down_px);

/// Returns the camera of the loupe: the burr at the centre of a picture of size `inset`, magnified by `power`
/// relative to the view.
Camera loupe_camera(const Camera& camera, const PixelSize& size, const Vec3& burr_W, const PixelSize& inset,
                    double power);

/// Returns the landmarks as a 3D Slicer markups file (.mrk.json), in LPS and mm.
std::string markups_text(const std::vector<Landmark>& landmarks);

}  // namespace osteomill::app
