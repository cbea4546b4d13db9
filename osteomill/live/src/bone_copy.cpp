#include "bone_copy.h"

#include <algorithm>
#include <utility>

#include "osteomill/volume/editable_volume.h"

namespace osteomill {

BoneCopy::BoneCopy(std::shared_ptr<Volume> bone, std::size_t undo_bytes,
                   std::function<void(const VoxelBox&)> changed)
    : bone_(std::move(bone)),
      copy_(std::make_shared<Volume>(*bone_)),
      changed_(std::move(changed)),
      history_(undo_bytes) {}

void BoneCopy::load_milled(const std::vector<DensityBlock>& milled) {
  for (DensityBlock block : milled) {
    DensityBlock same = block;
    EditableVolume(*bone_).swap(same);
    if (put(block)) history_.save(block);
  }
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

// Leaves in the block the densities that were there before. Returns whether any changed.
bool BoneCopy::put(DensityBlock& block) {
  const VoxelBox changed = EditableVolume(*copy_).swap(block);
  if (!changed.empty()) changed_(changed);
  return !changed.empty();
}

// `differing_` holds afterwards what was there, so that a second call takes the first one back.
void BoneCopy::put_differing() {
  for (DensityBlock& block : differing_) put(block);
}

void BoneCopy::set_isovalue(double isovalue) {
  EditableVolume(*copy_).set_isovalue(isovalue);
}

BoneCopy::NextBone BoneCopy::without(const CutHistory::PriorState& cuts, UndoScope undo_scope) {
  undo_scope_ = undo_scope;
  for (const auto& [place, block] : cuts.bricks) differing_.push_back(block);
  put_differing();
  return {copy_, cuts.removed_mm3, {}};
}

BoneCopy::NextBone BoneCopy::without_last_cut() {
  return without(history_.state_before_last_cut(), UndoScope::last_cut);
}

BoneCopy::NextBone BoneCopy::without_all_cuts() {
  return without(history_.state_before_all_cuts(), UndoScope::all);
}

BoneCopy::NextBone BoneCopy::with_emptied(double surroundings, double removed_mm3,
                                          const BoneDensities& densities) {
  emptied_ = std::max(emptied_, static_cast<float>(surroundings));
  differing_ = history_.lower_emptied_bricks(copy_->grid(), emptied_, copy_->isovalue(),
                                             static_cast<float>(densities.surroundings));
  put_differing();
  return {copy_, removed_mm3, densities};
}

void BoneCopy::exchange() {
  if (undo_scope_ == UndoScope::last_cut) history_.drop_last();
  if (undo_scope_ == UndoScope::all) history_.drop_all();
  undo_scope_ = UndoScope::nothing;
  std::swap(bone_, copy_);
  const Volume& bone = *bone_;
  EditableVolume copy(*copy_);
  for (const DensityBlock& block : differing_) {
    DensityBlock now(bone.grid(), block.first);
    copy.swap(now);
  }
  copy.set_isovalue(bone.isovalue());
  differing_.clear();
}

void BoneCopy::discard_next() {
  put_differing();
  differing_.clear();
  undo_scope_ = UndoScope::nothing;
  set_isovalue(bone_->isovalue());
}

}  // namespace osteomill
