#include "osteomill/haptics/bone_points/brick_points.h"

#include <algorithm>
#include <cmath>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

constexpr ShellPoint kNoPoint{PointChunk::kFarAway_mm, PointChunk::kFarAway_mm, PointChunk::kFarAway_mm, 0};

float distance_to(const ShellPoint& point, const std::array<float, 3>& centre) {
  const float dx = point.x_mm - centre[0], dy = point.y_mm - centre[1], dz = point.z_mm - centre[2];
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

// About the middle of the points' box; a hair wider than the farthest point, for the rounding of all who use
// it.
constexpr float kBoundSlack = 1.0001f;

BrickPoints::Bound bound_of(std::span<const ShellPoint> points) {
  BrickPoints::Bound bound;
  if (points.empty()) return bound;
  ShellPoint min = points.front(), max = points.front();
  for (const ShellPoint& point : points) {
    min = {std::min(min.x_mm, point.x_mm), std::min(min.y_mm, point.y_mm), std::min(min.z_mm, point.z_mm), 0};
    max = {std::max(max.x_mm, point.x_mm), std::max(max.y_mm, point.y_mm), std::max(max.z_mm, point.z_mm), 0};
  }
  bound.centre_mm = {0.5f * (min.x_mm + max.x_mm), 0.5f * (min.y_mm + max.y_mm),
                     0.5f * (min.z_mm + max.z_mm)};
  for (const ShellPoint& point : points) {
    bound.radius_mm = std::max(bound.radius_mm, kBoundSlack * distance_to(point, bound.centre_mm));
  }
  return bound;
}

}  // namespace

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

// Lengthens or shortens the brick's list of chunks; shorter than wanted where the pool has run out.
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

std::uint32_t BrickPoints::replace(std::size_t brick_index, std::span<const ShellPoint> points) {
  Brick& brick = bricks_[brick_index];
  set_chunk_count(brick, (points.size() + PointChunk::kSlots - 1) / PointChunk::kSlots);
  std::size_t stored = 0;
  for (std::uint32_t c = brick.first_chunk; c != kNoChunk; c = next_[c]) {
    for (std::size_t slot = 0; slot < PointChunk::kSlots; ++slot) {
      chunks_[c].set(slot, stored < points.size() ? points[stored++] : kNoPoint);
    }
  }
  dropped_ += points.size() - stored;
  total_ += stored - brick.count;
  brick.count = static_cast<std::uint32_t>(stored);
  brick.bound = bound_of(points.first(stored));
  return brick.count;
}

}  // namespace osteomill
