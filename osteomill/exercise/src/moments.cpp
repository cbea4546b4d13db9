#include "osteomill/exercise/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace osteomill {

namespace {

constexpr double kApart_s = 0.5;

void add_tick(Moment& moment, const Attempt& attempt, std::size_t tick) {
  moment.last_tick = tick;
  moment.time_s += attempt.ticks[tick].dt_s;
  moment.force_max_N = std::max(moment.force_max_N, attempt.ticks[tick].force_N);
}

bool is_over(const Moment& moment, const Attempt& attempt, std::size_t tick) {
  return attempt.ticks[tick].time_s - attempt.ticks[moment.last_tick].time_s >= kApart_s;
}

// Returns the volume removed outside the target in each tick.
std::map<std::size_t, double> outside_by_tick(const Attempt& attempt) {
  const double voxel_mm3 = attempt.exercise->scan.voxel_volume_mm3();
  std::map<std::size_t, double> taken_mm3;
  attempt.removed.for_each([&](const VoxelIndex& v) {
    const auto time_s = attempt.removed_at_s(v);
    if (!time_s || !attempt.exercise->is_outside(v)) return;
    const auto tick = std::ranges::lower_bound(attempt.ticks, static_cast<float>(*time_s), {},
                                               [](auto& t) { return static_cast<float>(t.time_s); });
    if (tick != attempt.ticks.end())
      taken_mm3[static_cast<std::size_t>(tick - attempt.ticks.begin())] += voxel_mm3;
  });
  return taken_mm3;
}

}  // namespace

std::vector<Moment> contacts_of(const Attempt& attempt, std::optional<std::size_t> structure) {
  std::vector<Moment> found;
  for (std::size_t n = 0; n < attempt.ticks.size(); ++n) {
    const double distance_mm = structure ? attempt.distance_mm(n, *structure) : attempt.distance_mm(n);
    if (!attempt.ticks[n].spindle_on || !(distance_mm <= 0)) continue;
    if (found.empty() || is_over(found.back(), attempt, n))
      found.push_back({.structure = structure.value_or(0), .first_tick = n});
    add_tick(found.back(), attempt, n);
  }
  return found;
}

std::vector<Moment> outside_removals_of(const Attempt& attempt) {
  constexpr double kLength_mm = 3;
  std::vector<Moment> found;
  for (const auto& [tick, taken_mm3] : outside_by_tick(attempt)) {
    const Vec3& burr_W = attempt.ticks[tick].burr_W;
    if (found.empty() || is_over(found.back(), attempt, tick) ||
        (burr_W - attempt.ticks[found.back().first_tick].burr_W).norm() > kLength_mm)
      found.push_back({.kind = Moment::Kind::outside, .first_tick = tick});
    add_tick(found.back(), attempt, tick);
    found.back().removed_mm3 += taken_mm3;
  }
  return found;
}

std::vector<Moment> moments_of(const Attempt& attempt) {
  std::vector<Moment> all = outside_removals_of(attempt);
  for (std::size_t n = 0; n < attempt.exercise->structures.size(); ++n) {
    const std::vector<Moment> contacts = contacts_of(attempt, n);
    all.insert(all.end(), contacts.begin(), contacts.end());
  }
  std::ranges::stable_sort(all, {}, &Moment::first_tick);
  return all;
}

double burr_speed_mm_s(const Attempt& attempt, std::size_t tick) {
  constexpr std::size_t kTicks = 5;
  const AttemptTick& before = attempt.ticks[tick - std::min(tick, kTicks)];
  const AttemptTick& after = attempt.ticks[std::min(tick + kTicks, attempt.ticks.size() - 1)];
  if (!before.is_placed || !after.is_placed || !(after.time_s > before.time_s))
    return std::numeric_limits<double>::quiet_NaN();
  return (after.burr_W - before.burr_W).norm() / (after.time_s - before.time_s);
}

}  // namespace osteomill
