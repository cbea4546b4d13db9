#pragma once

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns a camera that looks obliquely down at the point `entry_W`, where a tool enters the bone along the
/// unit vector `into_W`. Shows the whole bone if it is small (a tooth), else the region around the entry. The
/// unit vector `lateral_W`, perpendicular to `into_W`, turns the view about the entry. For square pictures.
/// The camera is so far away that lengths can be read off: objects nearer by half the picture's height are
/// drawn 2 % larger.
Camera camera_above(const Volume& bone, const Vec3& entry_W, const Vec3& into_W, const Vec3& lateral_W);
/// Returns a camera that looks at the entry along `into_W`, with `lateral_W` up.
Camera camera_along(const Volume& bone, const Vec3& entry_W, const Vec3& into_W, const Vec3& lateral_W);

/// Renders the bone on white with a scale bar, coloured and lit as in the window (`reference_density`: see
/// scene.h). `of_patient` adds the orientation letters; synthetic bones have none. Uses an OpenGL context of
/// its own; any thread, several at once. Builds the surface piece by piece, so that memory does not grow with
/// the scan. Throws std::runtime_error if OpenGL is unavailable or fails. Takes about a second: not real-time
/// safe.
Image bone_picture(const Volume& bone, double reference_density, const Camera& camera,
                   const PixelSize& size = {1120, 1120}, bool of_patient = false);

}  // namespace osteomill
