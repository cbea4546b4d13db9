#include "osteomill/live/cut_history.h"

#include <utility>

namespace osteomill {

namespace {

std::uint64_t place_of(const VoxelIndex& first) {
  const auto part = [](int voxel) { return static_cast<std::uint64_t>(voxel / DensityBlock::kVoxels); };
  return part(first.i) | part(first.j) << 20 | part(first.k) << 40;
}

// Whether any voxel was.
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

void CutHistory::keep(const DensityBlock& before) {
  const std::uint64_t place = place_of(before.first);
  first_.try_emplace(place, before);
  if (!cuts_.back().before.try_emplace(place, before).second) return;
  ++bricks_in_cuts_;
  forget_oldest();
}

void CutHistory::forget_oldest() {
  while (bricks_in_cuts_ > max_bricks_ && cuts_.size() > 1) {
    bricks_in_cuts_ -= cuts_.front().before.size();
    cuts_.pop_front();
    forgotten_ = true;
  }
}

void CutHistory::begin_cut(double removed_mm3) {
  if (!cuts_.back().before.empty()) cuts_.emplace_back();
  cuts_.back().removed_before_mm3 = removed_mm3;
}

std::size_t CutHistory::cuts() const {
  return cuts_.size() - (cuts_.back().before.empty() ? 1 : 0);
}

CutHistory::Taken CutHistory::take_last() {
  if (cuts_.back().before.empty() && cuts_.size() > 1) cuts_.pop_back();
  // With the first of all cuts nothing is milled any more.
  if (cuts_.size() == 1 && !forgotten_) return take_all();
  bricks_in_cuts_ -= cuts_.back().before.size();
  return {std::exchange(cuts_.back().before, {}), cuts_.back().removed_before_mm3, {}};
}

CutHistory::Taken CutHistory::take_all() {
  bricks_in_cuts_ = 0;
  return {std::exchange(first_, {}), 0, std::exchange(cuts_, std::deque<Cut>(1)),
          std::exchange(forgotten_, false)};
}

std::vector<DensityBlock> CutHistory::keep_emptied(const DensityGrid& grid, float emptied, double isovalue,
                                                   float floor) {
  for (Cut& cut : cuts_) {
    for (auto& [place, brick] : cut.before) {
      lower_emptied(brick, first_.at(place), emptied, isovalue, floor);
    }
  }
  std::vector<DensityBlock> differing;
  for (const auto& [place, first] : first_) {
    DensityBlock now(grid, first.first);
    if (lower_emptied(now, first, emptied, isovalue, floor)) differing.push_back(now);
  }
  return differing;
}

void CutHistory::put_back(Taken taken) {
  if (taken.cuts.empty()) {
    cuts_.back().before = std::move(taken.bricks);
    bricks_in_cuts_ += cuts_.back().before.size();
    return;
  }
  first_ = std::move(taken.bricks);
  cuts_ = std::move(taken.cuts);
  forgotten_ = taken.forgotten;
  for (const Cut& cut : cuts_) bricks_in_cuts_ += cut.before.size();
}

}  // namespace osteomill
