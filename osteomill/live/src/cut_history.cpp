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

void add(const std::vector<double>& drops, std::vector<double>& sum) {
  sum.resize(std::max(sum.size(), drops.size()));
  for (std::size_t n = 0; n < drops.size(); ++n) sum[n] += drops[n];
}

}  // namespace

void CutHistory::save(const DensityBlock& before) {
  for (const Cut& cut : undone_) bricks_in_cuts_ -= cut.bricks.size();
  undone_.clear();
  const std::uint64_t place = place_of(before.first);
  original_bricks_.try_emplace(place, before);
  if (!cuts_.back().bricks.try_emplace(place, before).second) return;
  ++bricks_in_cuts_;
  forget_oldest();
}

void CutHistory::forget_oldest() {
  while (bricks_in_cuts_ > max_bricks_ && cuts_.size() > 1) {
    bricks_in_cuts_ -= cuts_.front().bricks.size();
    add(cuts_.front().piece_drops, forgotten_piece_drops_);
    cuts_.pop_front();
    has_forgotten_cuts_ = true;
  }
}

void CutHistory::begin_cut(double removed_mm3) {
  if (!cuts_.back().bricks.empty()) cuts_.emplace_back();
  cuts_.back().removed_mm3 = removed_mm3;
}

void CutHistory::add_pieces(const std::vector<DensityBlock>& before, double removed_mm3,
                            std::vector<double> drops) {
  if (before.empty()) return;
  begin_cut(removed_mm3);
  for (const DensityBlock& brick : before) save(brick);
  set_piece_drops(std::move(drops));
  begin_cut(removed_mm3);
}

std::size_t CutHistory::cuts() const {
  return cuts_.size() - (cuts_.back().bricks.empty() ? 1 : 0);
}

std::vector<double> CutHistory::piece_drops() const {
  std::vector<double> sum = forgotten_piece_drops_;
  for (const Cut& cut : cuts_) add(cut.piece_drops, sum);
  return sum;
}

CutHistory::SavedState CutHistory::state_before_last_cut() const {
  const Cut& last = cuts_[std::max<std::size_t>(cuts(), 1) - 1];
  return {last.bricks, last.removed_mm3};
}

CutHistory::SavedState CutHistory::state_after_undone_cut() const {
  return {undone_.back().bricks, undone_.back().removed_mm3};
}

void CutHistory::exchange(Cut& cut, const std::vector<DensityBlock>& were, double removed_mm3) {
  for (const DensityBlock& brick : were) cut.bricks.at(place_of(brick.first)) = brick;
  cut.removed_mm3 = removed_mm3;
}

void CutHistory::record_undo(const std::vector<DensityBlock>& were, double removed_mm3) {
  if (cuts() == 0) return;
  if (cuts_.back().bricks.empty()) cuts_.pop_back();
  const double removed_before_mm3 = cuts_.back().removed_mm3;
  undone_.push_back(std::exchange(cuts_.back(), {{}, removed_before_mm3, {}}));
  exchange(undone_.back(), were, removed_mm3);
}

void CutHistory::record_redo(const std::vector<DensityBlock>& were, double removed_mm3) {
  if (undone_.empty()) return;
  const double removed_after_mm3 = undone_.back().removed_mm3;
  // `cuts_.back()` is empty: any new cut would have dropped the undone ones.
  cuts_.back() = std::move(undone_.back());
  undone_.pop_back();
  exchange(cuts_.back(), were, removed_mm3);
  begin_cut(removed_after_mm3);
}

void CutHistory::clear_history() {
  *this = CutHistory(max_bricks_ * sizeof(DensityBlock));
}

std::vector<DensityBlock> CutHistory::clear_emptied_voxels(const DensityGrid& grid, float emptied,
                                                           double isovalue, float floor) {
  const auto adapt = [&](Cut& cut) {
    for (auto& [place, brick] : cut.bricks) {
      lower_emptied(brick, original_bricks_.at(place), emptied, isovalue, floor);
    }
  };
  std::ranges::for_each(cuts_, adapt);
  std::ranges::for_each(undone_, adapt);
  std::vector<DensityBlock> differing;
  for (const auto& [place, first] : original_bricks_) {
    DensityBlock now(grid, first.first);
    if (lower_emptied(now, first, emptied, isovalue, floor)) differing.push_back(now);
  }
  return differing;
}

}  // namespace osteomill
