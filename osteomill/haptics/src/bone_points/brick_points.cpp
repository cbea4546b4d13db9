#include "bone_points/brick_points.h"

#include <algorithm>

#include "osteomill/base/work_progress.h"

#include "bone_points/brick_kernel.h"

namespace osteomill {

namespace {

// Copies the points from `first` to `count` and clears the remaining slots.
void fill(PointChunk& chunk, const PointRows& points, std::size_t first, std::size_t count) {
  const auto copy = [&](const std::vector<float>& from, std::array<float, PointChunk::kSlots>& to) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(first), PointChunk::kSlots, to.begin());
  };
  copy(points.x_mm, chunk.x_mm);
  copy(points.y_mm, chunk.y_mm);
  copy(points.z_mm, chunk.z_mm);
  copy(points.area_mm2, chunk.area_mm2);
  for (std::size_t slot = count - first; slot < PointChunk::kSlots; ++slot) chunk.clear(slot);
}

}  // namespace

PointRows::PointRows(std::size_t most) {
  for (std::vector<float>* row : {&x_mm, &y_mm, &z_mm, &area_mm2, &normal_x, &normal_y, &normal_z}) {
    row->resize(most + PointChunk::kSlots);
  }
}

BrickPoints::BrickPoints(std::size_t brick_count, std::size_t chunk_capacity)
    : next_(chunk_capacity), bricks_(brick_count), free_chunks_(chunk_capacity) {
  chunks_.reserve(chunk_capacity);
  constexpr std::size_t kAtOnce = 1 << 14;
  while (chunks_.size() < chunk_capacity) {
    chunks_.resize(std::min(chunks_.size() + kAtOnce, chunk_capacity));
    WorkProgress::done(chunks_.size(), chunk_capacity);
  }
  for (std::size_t n = chunk_capacity; n-- > 0;) {
    next_[n] = first_free_;
    first_free_ = static_cast<std::uint32_t>(n);
  }
}

std::uint32_t BrickPoints::take_chunk() {
  const std::uint32_t taken = first_free_;
  if (taken == kNoChunk) return kNoChunk;
  first_free_ = next_[taken];
  --free_chunks_;
  next_[taken] = kNoChunk;
  return taken;
}

// Extends or shortens the brick's list of chunks; to fewer than `wanted` if the pool is exhausted.
void BrickPoints::set_chunk_count(Brick& brick, std::size_t wanted) {
  std::uint32_t* link = &brick.first_chunk;
  for (std::size_t n = 0; n < wanted; ++n) {
    if (*link == kNoChunk) *link = take_chunk();
    if (*link == kNoChunk) return;
    link = &next_[*link];
  }
  std::uint32_t spare = *link;
  *link = kNoChunk;
  while (spare != kNoChunk) {
    const std::uint32_t after = next_[spare];
    next_[spare] = first_free_;
    first_free_ = spare;
    ++free_chunks_;
    spare = after;
  }
}

std::uint32_t BrickPoints::replace(std::size_t brick_index, const PointRows& points) {
  Brick& brick = bricks_[brick_index];
  set_chunk_count(brick, (points.count + PointChunk::kSlots - 1) / PointChunk::kSlots);
  std::size_t stored = 0;
  for (std::uint32_t c = brick.first_chunk; c != kNoChunk; c = next_[c]) {
    fill(chunks_[c], points, stored, points.count);
    stored = std::min(stored + PointChunk::kSlots, points.count);
  }
  dropped_ += points.count - stored;
  total_ += stored - brick.count;
  brick.count = static_cast<std::uint32_t>(stored);
  brick.bound = bound_of(points, stored);
  return brick.count;
}

}  // namespace osteomill
