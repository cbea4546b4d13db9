#pragma once

#include <cstdint>
#include <span>

#include "osteomill/milling/burr_reach.h"
#include "osteomill/milling/cut_voxels.h"

namespace osteomill {

/// The ball as the kernels below read it. They use vector instructions chosen at run time, with the same bits
/// from all of them. All distances are from the ball's centre, in the grid's axes, mm. Lists are worked
/// through in whole groups of up to `kLanes` entries, and so beyond their ends.
struct CutKernelBall {
  float radius;
  /// Unit vector.
  float ahead[3];
  float spacing[3];
  bool cubic;
};

/// A piece of a row: the densities of its `kLanes` voxels; where they lie from the ball's centre, `x` a voxel
/// each, `y` and `z` the whole row; the first voxel's column; and a bit for each voxel that is to be looked
/// at. `gather_piece` appends to `lists` those that the ball lowers with its leading half `max_ahead` ahead,
/// and returns a bit for each one looked at that is denser than the surroundings.
struct CutPiece {
  const float* densities;
  const float* x;
  float y, z;
  int column;
  unsigned bits;
};
unsigned gather_piece(const CutPiece& piece, const CutKernelBall& ball, const CutProfile& profile,
                      float max_ahead, CutLists& lists) noexcept;

/// Leading drops, their derivative by `ahead`, and trailing drops, over [begin, end), both multiples of
/// `kLanes`, in `kLanes` lanes each.
struct CutSums {
  alignas(64) float leading[CutLists::kLanes] = {};
  alignas(64) float slope[CutLists::kLanes] = {};
  alignas(64) float trailing[CutLists::kLanes] = {};
};
void sum_drops(const CutLists& lists, std::size_t begin, std::size_t end, float radius,
               const CutProfile& profile, float ahead, CutSums& sums) noexcept;

/// Fills `lists.after`.
void lower_densities(CutLists& lists, float radius, const CutProfile& profile, float ahead,
                     float leading_share, float trailing_share) noexcept;

/// Chooses the instructions. The first call of a kernel does that too, but asks the system for it.
void choose_cut_instructions();

/// Returns the sets of vector instructions for which this was compiled, as Highway numbers them. For tests.
std::int64_t cut_kernel_targets();

}  // namespace osteomill
