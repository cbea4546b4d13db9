#include "bone_copy.h"

#include <algorithm>
#include <utility>

#include "osteomill/volume/editable_volume.h"

namespace osteomill {

namespace {

// One sum per label, indexed by label place.
std::vector<double> zero_sums(const Volume& bone) {
  return std::vector<double>(bone.labels() ? bone.labels()->labels().size() + 1 : 0);
}

void add_drops(const DensityBlock& before, const Volume& now, std::vector<double>& drops) {
  if (drops.empty()) return;
  const double voxel_mm3 = now.geometry().voxel_volume_mm3();
  for_each(before.voxels_in(now.geometry()), [&](const VoxelIndex& v) {
    const LabelMap::LabelIndex label = now.labels()->at(v);
    if (label == 0) return;
    const float was = before.densities[before.index_of(v)];
    drops[label] += voxel_mm3 * (static_cast<double>(was) - static_cast<double>(now.grid()[v]));
  });
}

}  // namespace

BoneCopy::BoneCopy(std::shared_ptr<Volume> bone, std::size_t undo_bytes,
                   std::function<void(const VoxelBox&)> changed)
    : bone_(std::move(bone)),
      copy_(std::make_shared<Volume>(*bone_)),
      changed_(std::move(changed)),
      history_(undo_bytes) {}

void BoneCopy::load_milled(const std::vector<DensityBlock>& milled, const std::vector<double>& piece_drops) {
  for (DensityBlock block : milled) {
    DensityBlock same = block;
    EditableVolume(*bone_).swap(same);
    if (put(block)) history_.save(block);
  }
  // Sums of another label map do not apply here.
  if (piece_drops.size() == zero_sums(*copy_).size()) history_.set_piece_drops(piece_drops);
}

std::vector<double> BoneCopy::drops_by_label() const {
  std::vector<double> drops = zero_sums(*copy_);
  for (const auto& [place, before] : history_.original_bricks()) add_drops(before, *copy_, drops);
  const std::vector<double> pieces = history_.piece_drops();
  for (std::size_t n = 0; n < std::min(drops.size(), pieces.size()); ++n) drops[n] -= pieces[n];
  return drops;
}

VoxelBox BoneCopy::drain_queue(DensityHandover& handover) {
  VoxelBox arrived;
  DensityBlock* block = handover.front();
  for (std::size_t n = 0; block != nullptr && n < DensityHandover::kMaxBricksInFlight; ++n) {
    if (put(*block)) {
      history_.save(*block);
      arrived.include(block->first);
      arrived.include(block->last());
    }
    handover.pop();
    block = handover.front();
  }
  return arrived;
}

// Swaps the block's densities with the copy's. Returns whether any changed.
bool BoneCopy::put(DensityBlock& block) {
  const VoxelBox changed = EditableVolume(*copy_).swap(block);
  if (!changed.empty()) changed_(changed);
  return !changed.empty();
}

// Also swaps the densities, so a second call undoes the first.
void BoneCopy::put_differing() {
  for (DensityBlock& block : differing_) put(block);
}

void BoneCopy::set_isovalue(double isovalue) {
  EditableVolume(*copy_).set_isovalue(isovalue);
}

BoneCopy::NextBone BoneCopy::with(const CutHistory::SavedState& state, Step step, double removed_mm3) {
  step_ = step;
  removed_mm3_ = removed_mm3;
  for (const auto& [place, block] : state.bricks) differing_.push_back(block);
  put_differing();
  return {copy_, state.removed_mm3, {}};
}

BoneCopy::NextBone BoneCopy::without_last_cut(double removed_mm3) {
  return with(history_.state_before_last_cut(), Step::undo, removed_mm3);
}

BoneCopy::NextBone BoneCopy::with_undone_cut(double removed_mm3) {
  // Something may have been cut since the user requested the redo.
  if (history_.undone_cuts() == 0) return {copy_, removed_mm3, {}};
  return with(history_.state_after_undone_cut(), Step::redo, removed_mm3);
}

BoneCopy::NextBone BoneCopy::without_all_cuts() {
  return with(history_.state_before_all_cuts(), Step::reset, 0);
}

BoneCopy::NextBone BoneCopy::without_pieces(std::vector<DensityBlock> without, double removed_mm3) {
  step_ = Step::pieces;
  removed_mm3_ = removed_mm3;
  differing_ = std::move(without);
  put_differing();
  return {copy_, removed_mm3, {}};
}

BoneCopy::NextBone BoneCopy::with_emptied(double surroundings, double removed_mm3,
                                          const BoneDensities& densities) {
  emptied_ = std::max(emptied_, static_cast<float>(surroundings));
  differing_ = history_.clear_emptied_voxels(copy_->grid(), emptied_, copy_->isovalue(),
                                             static_cast<float>(densities.surroundings));
  put_differing();
  return {copy_, removed_mm3, densities};
}

void BoneCopy::note_step() {
  switch (std::exchange(step_, Step::none)) {
    case Step::none:
      return;
    case Step::undo:
      return history_.record_undo(differing_, removed_mm3_);
    case Step::redo:
      return history_.record_redo(differing_, removed_mm3_);
    case Step::reset:
      return history_.clear_history();
    case Step::pieces:
      break;
  }
  std::vector<double> drops = zero_sums(*copy_);
  for (const DensityBlock& before : differing_) add_drops(before, *copy_, drops);
  history_.add_pieces(differing_, removed_mm3_, std::move(drops));
}

void BoneCopy::exchange() {
  // The haptic thread already uses the other bone, so nothing before this line may throw.
  std::swap(bone_, copy_);
  const Volume& bone = *bone_;
  EditableVolume copy(*copy_);
  for (const DensityBlock& block : differing_) {
    DensityBlock now(bone.grid(), block.first);
    copy.swap(now);
  }
  copy.set_isovalue(bone.isovalue());
  note_step();
  differing_.clear();
}

void BoneCopy::discard_next() {
  put_differing();
  differing_.clear();
  step_ = Step::none;
  set_isovalue(bone_->isovalue());
}

}  // namespace osteomill
