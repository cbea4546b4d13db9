#pragma once

#include "osteomill/image/image.h"
#include "osteomill/view/annotations.h"

namespace osteomill {

/// The font of all that is written; where this file is missing, the one that comes with Dear ImGui is used.
inline constexpr const char* kFontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
inline constexpr float kFontSize_px = 14;

/// Grey levels of what is drawn and of the edge around it, which keeps it readable before anything.
struct Ink {
  unsigned char level;
  unsigned char edge;
};
inline constexpr Ink kInkOnLight{40, 255};
inline constexpr Ink kInkOnDark{236, 0};

/// Draws an annotation into an image, all its lengths times `scale`. Any thread.
void draw_annotation(Image& image, const Annotation& annotation, const Ink& ink, double scale = 1);

}  // namespace osteomill
