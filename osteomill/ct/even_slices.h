#pragma once

#include <vector>

#include "osteomill/ct/slice_stack.h"

namespace osteomill {

/// Interpolates slices that lie at uneven distances (`SliceStack::heights_mm`) linearly to the even ones of
/// the stack's grid, from pixel to pixel, so along the axis of a tilted gantry's table. `densities`, slice
/// after slice as they were read, are replaced. An even stack is left alone.
void even_out_slices(SliceStack& stack, std::vector<float>& densities);

}  // namespace osteomill
