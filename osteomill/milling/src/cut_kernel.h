#pragma once

#include <cstdint>
#include <span>

#include "osteomill/milling/burr_reach.h"
#include "osteomill/milling/cut_voxels.h"

namespace osteomill {

/// The ball in the form that the kernels below take. They use vector instructions chosen at run time; all
/// instruction sets give bit-identical results. All distances are relative to the ball's centre, in the
/// grid's axes, mm. Lists are processed in whole groups of up to `kLanes` entries, so their padding is read
/// and written too.
struct CutKernelBall {
  float radius;
  /// Unit vector.
  float ahead[3];
  float spacing[3];
  bool cubic;
};

/// A piece of a row: the densities of its `kLanes` voxels; their positions relative to the ball's centre (`x`
/// per voxel, `y` and `z` for the whole row); the first voxel's column; and a mask of the voxels to process.
/// `gather_piece` appends to `lists` those that the ball lowers if its leading half is `max_ahead` ahead. It
/// returns the mask of processed voxels that are denser than the surroundings.
struct CutPiece {
  const float* densities;
  const float* x;
  float y, z;
  int column;
  unsigned bits;
};
unsigned gather_piece(const CutPiece& piece, const CutKernelBall& ball, const CutProfile& profile,
                      float max_ahead, CutLists& lists) noexcept;

/// Sums of the leading drops, of their derivative with respect to `ahead`, and of the trailing drops over
/// [begin, end), one partial sum per lane. `begin` and `end` must be multiples of `kLanes`.
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

/// Chooses the instruction set. The first kernel call would do it otherwise, with a system call.
void choose_cut_instructions();

/// Returns the instruction sets this was compiled for, as Highway's bit mask. For tests.
std::int64_t cut_kernel_targets();

}  // namespace osteomill
