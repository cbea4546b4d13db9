#pragma once

#include "osteomill/surface/image.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Where a picture is taken from: parallel rays along `direction_W`, so that lengths can be read off.
struct PictureView {
  /// Lies in the middle of the picture.
  Vec3 centre_W = Vec3::Zero();
  /// The way the rays go, and what is up in the picture; neither zero nor along the other. Any length.
  Vec3 direction_W = -Vec3::UnitZ();
  Vec3 up_W = Vec3::UnitY();
  /// What the picture's width shows.
  double width_mm = 30;
  int width_pixels = 800;
  int height_pixels = 800;
  bool scale_bar = false;
};

/// The view along `direction_W` that just holds the volume's bone (the whole grid where there is none), with
/// a twelfth of a margin.
PictureView view_of_bone(const Volume& volume, const Vec3& direction_W, const Vec3& up_W,
                         int width_pixels = 800, int height_pixels = 800);

/// A picture of the isosurface on white, lit from the viewer's side and shaded where other bone stands around
/// it. What is dense below the surface (enamel) is whiter than what is not (dentine, bone). Where bone
/// reaches the grid's border, its cut face is drawn. The picture does not depend on how many threads draw it.
/// Throws std::invalid_argument where the view makes no sense. Takes a second or so: not for the tick.
Image isosurface_picture(const Volume& volume, const PictureView& view);

}  // namespace osteomill
