#pragma once

#include <string>
#include <vector>

#include "osteomill/ct/slice_stack.h"

namespace osteomill {

/// Interpolates slices that lie at uneven distances (`SliceStack::heights_mm`) linearly to the even ones of
/// the stack's grid, from pixel to pixel, so along the axis of a tilted gantry's table. `densities`, slice
/// after slice as they were read, are replaced. An even stack is left alone.
void even_out_slices(SliceStack& stack, std::vector<float>& densities);

/// Moves every slice of a stack that was taken with a tilted gantry to its place in a straight grid, by
/// linear interpolation within the slice. The grid grows so that nothing is lost; `densities` and `stack` are
/// replaced, where there were no pixels the least density stands, and a warning says so. A straight stack is
/// left alone. Throws InputError naming `subject` where the tilt is more than a gantry can do.
void correct_gantry_tilt(const std::string& subject, SliceStack& stack, std::vector<float>& densities);

}  // namespace osteomill
