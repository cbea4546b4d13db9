#pragma once

#include <string>
#include <vector>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"

namespace osteomill {

/// A line or a word drawn over the picture, pixels from the top left.
struct Annotation {
  /// A line from a pixel to another.
  struct Line {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };
  std::vector<Line> lines;
  /// The middle of the text.
  Eigen::Vector2d text_centre_px = Eigen::Vector2d::Zero();
  std::string text;
};

/// Returns a bar of a round length in mm, at most a quarter of the picture long, in its lower left corner. It
/// holds at the camera's focus; its text says so if nearer things are drawn noticeably larger.
Annotation scale_bar_annotation(const Camera& camera, const PixelSize& size);

/// Returns the patient's directions (L R A P S I, of W's LPS axes) about a point in the lower right corner,
/// each where its direction points; those that point almost at the viewer, or away, are left out.
std::vector<Annotation> orientation_letters(const Camera& camera, const PixelSize& size);

/// The font of all texts; if this file is missing, the one that comes with Dear ImGui is used.
inline constexpr const char* kFontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
/// The size of all texts at scale 1.
inline constexpr float kFontSize_px = 14;

/// Grey levels of what is drawn and of the edge around it, which keeps it readable before anything.
struct Ink {
  unsigned char level;
  unsigned char edge;
};
/// The ink for pictures on white.
inline constexpr Ink kInkOnLight{40, 255};
/// The ink for the window's dark ground.
inline constexpr Ink kInkOnDark{236, 0};

/// Draws an annotation into an image, all its lengths times `scale`. Any thread.
void draw_annotation(Image& image, const Annotation& annotation, const Ink& ink, double scale = 1);

/// Draws the scale bar, and with `of_patient` the letters of the patient's directions, laid out as in an
/// image `scale` times smaller.
void annotate(Image& image, const Camera& camera, bool of_patient, const Ink& ink, double scale);

}  // namespace osteomill
