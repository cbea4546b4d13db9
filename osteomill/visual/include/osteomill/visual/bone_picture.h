#pragma once

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns a camera that looks obliquely down at where a tool enters the bone at `entry_W` along the unit
/// vector `into_W`: at all of the bone if it is small (a tooth), else at what lies around the entry.
/// `lateral_W` is a unit vector across, which turns the view about the entry. For square pictures. From far
/// away, so that lengths can be read off: what is nearer by half of the picture's height is drawn 2 % larger.
Camera camera_above(const Volume& bone, const Vec3& entry_W, const Vec3& into_W, const Vec3& lateral_W);
/// Returns a camera that looks at the entry straight along `into_W`, with `lateral_W` upwards.
Camera camera_along(const Volume& bone, const Vec3& entry_W, const Vec3& into_W, const Vec3& lateral_W);

/// Draws a picture of the bone on white with a scale bar, coloured and lit as in the window (scene.h says
/// what `reference_density` is), drawn with an OpenGL context of its own; any thread, several at once. What
/// the bone's surface needs is made piece by piece, so that a large scan takes no more memory than a small
/// one. Throws std::runtime_error if there is no OpenGL or it refuses something. Takes a second or so: not
/// for the tick.
/// `of_patient` adds the letters of the patient's directions, which a made-up bone does not have.
Image bone_picture(const Volume& bone, double reference_density, const Camera& camera,
                   const PixelSize& size = {1120, 1120}, bool of_patient = false);

}  // namespace osteomill
