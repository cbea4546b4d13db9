#include "osteomill/recording/recorded_bone.h"

#include <algorithm>
#include <iterator>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/volume/editable_volume.h"

#include "repeated_session.h"

namespace osteomill {

namespace {

// Initial checkpoint interval, ticks; these are milled again in some hundredths of a second.
constexpr std::size_t kEveryTicks = 1000;

VoxelIndex voxel_at(const GridGeometry& geometry, std::size_t number) {
  const auto [i, j, k] = cell_at(geometry.dims, number);
  return {i, j, k};
}

}  // namespace

RecordedBone::RecordedBone(const Volume& scan, const Recording& recording, std::size_t max_bytes)
    : scan_(scan), bone_(scan), recording_(recording), max_bytes_(max_bytes), every_ticks_(kEveryTicks) {
  require_made_with(recording, scan);
  require_complete(recording);
  std::set<std::size_t> changed;
  const auto note = [&](const VoxelBox& voxels) {
    for_each(voxels.bricks(DensityBlock::kVoxels), [&](const VoxelIndex& brick) {
      const std::size_t number =
          bone_.grid().linear_index(VoxelBox::of_brick(brick, DensityBlock::kVoxels).first);
      changed.insert(number);
      // Entered even without a checkpoint, because the next session resets all bricks listed here.
      bricks_[number];
    });
  };
  while (ticks_ < recording.records.size()) {
    mill_next(note);
    if (ticks_ % every_ticks_ != 0) continue;
    add_checkpoint(std::exchange(changed, {}));
    WorkProgress::done(ticks_, recording.records.size());
  }
}

RecordedBone::~RecordedBone() = default;

void RecordedBone::put(DensityBlock brick, const OnChange& changed) {
  const VoxelBox voxels = EditableVolume(bone_).swap(brick);
  if (!voxels.empty() && changed) changed(voxels);
}

void RecordedBone::begin_session(std::size_t session, const OnChange& changed) {
  const SessionStart& start = recording_.sessions[session].start;
  for (const auto& [number, versions] : bricks_)
    put({scan_.grid(), voxel_at(scan_.geometry(), number)}, changed);
  for (const DensityBlock& brick : start.bricks) put(brick, changed);
  EditableVolume(bone_).set_isovalue(start.run.isovalue);
  session_ = std::make_unique<RepeatedSession>(bone_, recording_, session, ticks_);
}

void RecordedBone::mill_next(const OnChange& changed) {
  const std::size_t session = recording_.records[ticks_].session;
  if (recording_.sessions[session].first == ticks_) begin_session(session, changed);
  const VolumeChange change = session_->mill_next();
  if (!change.voxels.empty() && changed) changed(change.voxels);
  ++ticks_;
}

void RecordedBone::add_checkpoint(const std::set<std::size_t>& changed) {
  for (const std::size_t number : changed) {
    auto now = std::make_unique<DensityBlock>(bone_.grid(), voxel_at(bone_.geometry(), number));
    Versions& versions = bricks_[number];
    const auto& before = versions.empty() ? DensityBlock(scan_.grid(), now->first).densities
                                          : versions.back().second->densities;
    if (now->densities == before) continue;
    // Replaces a version of a dropped checkpoint that was moved to this one.
    if (!versions.empty() && versions.back().first == ticks_) {
      versions.back().second = std::move(now);
    } else {
      versions.emplace_back(ticks_, std::move(now));
      ++kept_bricks_;
    }
  }
  checkpoints_.push_back({ticks_, session_->memory()});
  while (bytes() > max_bytes_ && checkpoints_.size() > 1) drop_every_second_checkpoint();
}

// Bricks of a dropped checkpoint move to the next one, unless that has its own version.
void RecordedBone::drop_every_second_checkpoint() {
  every_ticks_ *= 2;
  std::erase_if(checkpoints_, [&](const Checkpoint& one) { return one.ticks % every_ticks_ != 0; });
  kept_bricks_ = 0;
  for (auto& [number, versions] : bricks_) {
    Versions left;
    for (auto& [ticks, brick] : versions) {
      const std::size_t kept_for = (ticks + every_ticks_ - 1) / every_ticks_ * every_ticks_;
      if (!left.empty() && left.back().first == kept_for) left.pop_back();
      left.emplace_back(kept_for, std::move(brick));
    }
    versions = std::move(left);
    kept_bricks_ += versions.size();
  }
}

// Restores the last checkpoint at or before `ticks`, or the scan if there is none.
void RecordedBone::restore(std::size_t ticks, const OnChange& changed) {
  const auto after = std::ranges::upper_bound(checkpoints_, ticks, {}, &Checkpoint::ticks);
  const Checkpoint* const from = after == checkpoints_.begin() ? nullptr : &*std::prev(after);
  ticks_ = from == nullptr ? 0 : from->ticks;
  for (const auto& [number, versions] : bricks_) {
    const auto later = std::ranges::upper_bound(versions, ticks_, {}, &Versions::value_type::first);
    if (later == versions.begin()) {
      put({scan_.grid(), voxel_at(scan_.geometry(), number)}, changed);
    } else {
      put(*std::prev(later)->second, changed);
    }
  }
  const std::size_t session = ticks_ == 0 ? 0 : recording_.records[ticks_ - 1].session;
  EditableVolume(bone_).set_isovalue(ticks_ == 0 ? scan_.isovalue()
                                                 : recording_.sessions[session].start.run.isovalue);
  session_.reset();
  if (from != nullptr)
    session_ = std::make_unique<RepeatedSession>(bone_, recording_, session, ticks_, from->mill);
}

void RecordedBone::go_to(std::size_t ticks, const OnChange& changed) {
  ticks = std::min(ticks, recording_.records.size());
  const auto after = std::ranges::upper_bound(checkpoints_, ticks, {}, &Checkpoint::ticks);
  const std::size_t nearest = after == checkpoints_.begin() ? 0 : std::prev(after)->ticks;
  if (ticks < ticks_ || nearest > ticks_) restore(ticks, changed);
  try {
    while (ticks_ < ticks) mill_next(changed);
  } catch (const InputError&) {
    // If the burr covers more voxels than a step's budget, milling depends on more than BurrMill::Memory and
    // may differ from a checkpoint on. Replays from the start of the session instead.
    ticks_ = recording_.sessions[recording_.records[ticks - 1].session].first;
    while (ticks_ < ticks) mill_next(changed);
  }
}

}  // namespace osteomill
