#include "osteomill/haptics/bone_points/crossing_kernel.h"

// AVX3_DL and SSSE3 have nothing for us over their neighbours.
#define HWY_DISABLED_TARGETS \
  (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "osteomill/haptics/bone_points/crossing_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace osteomill {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Never hn::MulAdd: it rounds once where the processor can, and twice elsewhere.
using D = hn::CappedTag<float, CrossingRow::kNodes>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t kWidth = hn::MaxLanes(d);

// Of the area of a cell's face that a crossing stands for.
constexpr float kMinSeen = 0.02f;
constexpr float kSeenWithoutNormal = 0.6f;

// Central differences at both ends, in proportion.
HWY_INLINE V gradient(const float* here, const float* there, std::ptrdiff_t next, float per_step,
                      V fraction) {
  const V from = hn::Sub(hn::LoadU(d, here + next), hn::LoadU(d, here - next));
  const V to = hn::Sub(hn::LoadU(d, there + next), hn::LoadU(d, there - next));
  return hn::Mul(hn::Add(from, hn::Mul(fraction, hn::Sub(to, from))), hn::Set(d, per_step));
}

HWY_INLINE void add_to(float* sums, V value) {
  hn::StoreU(hn::Add(hn::LoadU(d, sums), value), d, sums);
}

void AddCrossings(const CrossingLattice& lattice, const CrossingRow& row, CrossingSums& sums) {
  for (std::size_t lane = 0; lane < CrossingRow::kNodes; lane += kWidth) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint8_t bits[8] = {
          static_cast<std::uint8_t>((row.crossed[axis] >> lane) & ((1u << kWidth) - 1))};
      if (bits[0] == 0) continue;
      const auto crossed = hn::LoadMaskBits(d, bits);
      const float* here = row.densities + lane;
      const float* there = here + lattice.next[axis];
      const V density = hn::LoadU(d, here);
      const V fraction = hn::IfThenElseZero(crossed, hn::Div(hn::Sub(hn::Set(d, lattice.isovalue), density),
                                                             hn::Sub(hn::LoadU(d, there), density)));
      V g[3];
      for (int a = 0; a < 3; ++a)
        g[a] = gradient(here, there, lattice.next[a], lattice.steps.per_step[a], fraction);
      const V steepness =
          hn::Sqrt(hn::Add(hn::Add(hn::Mul(g[0], g[0]), hn::Mul(g[1], g[1])), hn::Mul(g[2], g[2])));
      const auto has_normal = hn::Gt(steepness, hn::Zero(d));
      const V outward = hn::IfThenElseZero(has_normal, hn::Div(hn::Set(d, -1.0f), steepness));
      const V along = hn::Max(hn::Set(d, kMinSeen), hn::Abs(hn::Mul(outward, g[axis])));
      const V seen = hn::IfThenElse(has_normal, along, hn::Set(d, kSeenWithoutNormal));
      const V area = hn::IfThenElseZero(crossed, hn::Mul(hn::Set(d, lattice.steps.face[axis]), seen));
      V at[3] = {hn::Iota(d, static_cast<float>(row.i + static_cast<int>(lane))),
                 hn::Set(d, static_cast<float>(row.j)), hn::Set(d, static_cast<float>(row.k))};
      at[axis] = hn::Add(at[axis], fraction);
      for (int a = 0; a < 3; ++a) {
        add_to(&sums.rows[a][lane], hn::Mul(area, hn::Mul(at[a], hn::Set(d, lattice.steps.step[a]))));
        add_to(&sums.rows[4 + a][lane], hn::Mul(area, hn::Mul(outward, g[a])));
      }
      add_to(&sums.rows[3][lane], area);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteomill
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteomill {

HWY_EXPORT(AddCrossings);

void add_crossings(const CrossingLattice& lattice, const CrossingRow& row, CrossingSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddCrossings)(lattice, row, sums);
}

std::int64_t crossing_kernel_targets() {
  return HWY_TARGETS;
}

}  // namespace osteomill
#endif
