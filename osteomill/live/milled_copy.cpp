#include "osteomill/live/milled_copy.h"

#include <algorithm>
#include <utility>

namespace osteomill {

namespace {

constexpr int kSide = DensityHandover::kBrickVoxels;

}  // namespace

MilledCopy::MilledCopy(DensityGrid grid, std::size_t undo_bytes)
    : grid_(std::move(grid)), greatest_bricks_(undo_bytes / sizeof(Densities)), cuts_(1) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    brick_dims_[axis] = (grid_.geometry().dims[axis] + kSide - 1) / kSide;
  }
}

std::size_t MilledCopy::number_of(const VoxelIndex& first) const {
  const auto place = [](int voxel) { return static_cast<std::size_t>(voxel / kSide); };
  return place(first.i) + static_cast<std::size_t>(brick_dims_[0]) *
                              (place(first.j) + static_cast<std::size_t>(brick_dims_[1]) * place(first.k));
}

// The voxels of a brick that lie in the grid, with their place in the brick.
template <typename Visit>
void MilledCopy::visit_voxels(std::size_t number, const Visit& visit) const {
  const auto bi = static_cast<int>(number % static_cast<std::size_t>(brick_dims_[0]));
  const auto rows = static_cast<int>(number / static_cast<std::size_t>(brick_dims_[0]));
  const VoxelIndex first{kSide * bi, kSide * (rows % brick_dims_[1]), kSide * (rows / brick_dims_[1])};
  for (int k = 0; k < kSide; ++k) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const VoxelIndex voxel{first.i + i, first.j + j, first.k + k};
        if (grid_.contains(voxel)) visit(voxel, static_cast<std::size_t>(i + kSide * (j + kSide * k)));
      }
    }
  }
}

std::unique_ptr<MilledCopy::Densities> MilledCopy::as_now(std::size_t number) const {
  auto densities = std::make_unique<Densities>();
  visit_voxels(number,
               [&](const VoxelIndex& voxel, std::size_t place) { (*densities)[place] = grid_[voxel]; });
  return densities;
}

bool MilledCopy::put(const DensityHandover::Brick& brick) {
  const std::size_t number = number_of(brick.first);
  bool differs = false;
  visit_voxels(number, [&](const VoxelIndex& voxel, std::size_t place) {
    differs = differs || grid_[voxel] != brick.densities[place];
  });
  if (!differs) return false;
  if (!first_.contains(number)) first_.emplace(number, as_now(number));
  if (Bricks& before = cuts_.back().before; !before.contains(number)) {
    before.emplace(number, as_now(number));
    ++bricks_in_cuts_;
    forget_oldest();
  }
  visit_voxels(number,
               [&](const VoxelIndex& voxel, std::size_t place) { grid_.set(voxel, brick.densities[place]); });
  return true;
}

void MilledCopy::forget_oldest() {
  while (bricks_in_cuts_ > greatest_bricks_ && cuts_.size() > 1) {
    bricks_in_cuts_ -= cuts_.front().before.size();
    cuts_.pop_front();
  }
}

void MilledCopy::begin_cut(double removed_mm3) {
  if (!cuts_.back().before.empty()) cuts_.emplace_back();
  cuts_.back().removed_before_mm3 = removed_mm3;
}

std::size_t MilledCopy::cuts() const {
  return cuts_.size() - (cuts_.back().before.empty() ? 1 : 0);
}

double MilledCopy::undo() {
  if (cuts_.back().before.empty() && cuts_.size() > 1) cuts_.pop_back();
  const double removed_mm3 = cuts_.back().removed_before_mm3;
  restore(cuts_.back().before);
  bricks_in_cuts_ -= cuts_.back().before.size();
  cuts_.back().before.clear();
  return removed_mm3;
}

void MilledCopy::reset() {
  restore(first_);
  first_.clear();
  cuts_.clear();
  cuts_.resize(1);
  bricks_in_cuts_ = 0;
}

void MilledCopy::restore(const Bricks& bricks) {
  for (const auto& [number, densities] : bricks) {
    visit_voxels(number,
                 [&](const VoxelIndex& voxel, std::size_t place) { grid_.set(voxel, (*densities)[place]); });
  }
}

}  // namespace osteomill
