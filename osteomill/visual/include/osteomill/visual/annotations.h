#pragma once

#include <string>
#include <vector>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"

namespace osteomill {

/// Lines or text drawn over the picture; pixels from the top left.
struct Annotation {
  /// A line segment.
  struct Line {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };
  std::vector<Line> lines;
  /// Centre of the text.
  Eigen::Vector2d text_centre_px = Eigen::Vector2d::Zero();
  std::string text;
};

/// Returns a scale bar of a round length in mm, at most a quarter of the picture long, in the lower left
/// corner. Valid at the camera's focus; its text says so if perspective noticeably enlarges nearer objects.
Annotation scale_bar_annotation(const Camera& camera, const PixelSize& size);

/// Returns the patient's directions (L R A P S I, from W's LPS axes) around a point in the lower right
/// corner, each in its projected direction; omits those that point almost along the line of sight.
std::vector<Annotation> orientation_letters(const Camera& camera, const PixelSize& size);

/// Font of all texts; if the file is missing, Dear ImGui's built-in font is used.
inline constexpr const char* kFontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
/// Font size of all texts at scale 1.
inline constexpr float kFontSize_px = 14;

/// Grey levels of lines and text, and of the outline that keeps them legible on any background.
struct Ink {
  unsigned char level;
  unsigned char edge;
};
/// Ink for pictures on white.
inline constexpr Ink kInkOnLight{40, 255};
/// Ink for the window's dark background.
inline constexpr Ink kInkOnDark{236, 0};

/// Draws an annotation into an image, with all lengths multiplied by `scale`. Any thread.
void draw_annotation(Image& image, const Annotation& annotation, const Ink& ink, double scale = 1);

/// Draws the scale bar and, if `of_patient`, the orientation letters, with the layout of an image `scale`
/// times smaller.
void annotate(Image& image, const Camera& camera, bool of_patient, const Ink& ink, double scale);

}  // namespace osteomill
