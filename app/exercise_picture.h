#pragma once

#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"
#include "osteomill/volume/volume.h"

namespace osteomill::app {

/// Draws the exercise's picture for the start page: the bone cut open through the middle of the target, with
/// target, structures and bone to be kept in their colours. Structures are not cut. Throws std::runtime_error
/// if there is no OpenGL. Takes seconds.
Image exercise_picture(const PlacedExercise& placed, const Volume& scan, const PixelSize& size);

}  // namespace osteomill::app
