#include "cut_history.h"

#include <algorithm>

namespace osteomill {

namespace {

std::uint64_t place_of(const VoxelIndex& first) {
  const auto part = [](int voxel) { return static_cast<std::uint64_t>(voxel / DensityBlock::kVoxels); };
  return part(first.i) | part(first.j) << 20 | part(first.k) << 40;
}

// Lowers the emptied voxels of a brick. Returns whether any voxel changed.
bool lower_emptied(DensityBlock& brick, const DensityBlock& first, float emptied, double isovalue,
                   float floor) {
  bool lowered = false;
  for (std::size_t n = 0; n < brick.densities.size(); ++n) {
    float& density = brick.densities[n];
    if (density >= first.densities[n] || density > emptied || static_cast<double>(density) <= isovalue)
      continue;
    density = floor;
    lowered = true;
  }
  return lowered;
}

}  // namespace

void CutHistory::save(const DensityBlock& before) {
  const std::uint64_t place = place_of(before.first);
  original_bricks_.try_emplace(place, before);
  if (!cuts_.back().before.try_emplace(place, before).second) return;
  ++bricks_in_cuts_;
  forget_oldest();
}

void CutHistory::forget_oldest() {
  while (bricks_in_cuts_ > max_bricks_ && cuts_.size() > 1) {
    bricks_in_cuts_ -= cuts_.front().before.size();
    cuts_.pop_front();
    has_forgotten_cuts_ = true;
  }
}

void CutHistory::begin_cut(double removed_mm3) {
  if (!cuts_.back().before.empty()) cuts_.emplace_back();
  cuts_.back().removed_before_mm3 = removed_mm3;
}

std::size_t CutHistory::cuts() const {
  return cuts_.size() - (cuts_.back().before.empty() ? 1 : 0);
}

CutHistory::PriorState CutHistory::state_before_last_cut() const {
  if (last_cut_is_all()) return state_before_all_cuts();
  const Cut& last = cuts_[std::max<std::size_t>(cuts(), 1) - 1];
  return {last.before, last.removed_before_mm3};
}

void CutHistory::drop_last() {
  if (last_cut_is_all()) return drop_all();
  if (cuts_.back().before.empty() && cuts_.size() > 1) cuts_.pop_back();
  bricks_in_cuts_ -= cuts_.back().before.size();
  cuts_.back().before.clear();
}

void CutHistory::drop_all() {
  original_bricks_.clear();
  cuts_ = std::deque<Cut>(1);
  bricks_in_cuts_ = 0;
  has_forgotten_cuts_ = false;
}

std::vector<DensityBlock> CutHistory::lower_emptied_bricks(const DensityGrid& grid, float emptied,
                                                           double isovalue, float floor) {
  for (Cut& cut : cuts_) {
    for (auto& [place, brick] : cut.before) {
      lower_emptied(brick, original_bricks_.at(place), emptied, isovalue, floor);
    }
  }
  std::vector<DensityBlock> differing;
  for (const auto& [place, first] : original_bricks_) {
    DensityBlock now(grid, first.first);
    if (lower_emptied(now, first, emptied, isovalue, floor)) differing.push_back(now);
  }
  return differing;
}

}  // namespace osteomill
