#pragma once

#include "osteomill/surface/image.h"

namespace osteomill {

/// The length a scale bar is given: 1, 2 or 5 times a power of ten, mm, at most `longest_mm` (above 0).
double scale_bar_length_mm(double longest_mm);

/// Draws a bar with its length in mm over it into the lower left corner, at most a quarter of the image long.
void draw_scale_bar(Image& image, double mm_per_pixel);

}  // namespace osteomill
