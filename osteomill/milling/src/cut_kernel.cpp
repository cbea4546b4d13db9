#include "cut_kernel.h"

// AVX3_DL and SSSE3 bring no gain here over the next lower target.
#define HWY_DISABLED_TARGETS \
  (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cut_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "osteomill/base/compress_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteomill {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Never hn::MulAdd: it rounds once if the processor can, and twice elsewhere.
using D = hn::CappedTag<float, CutLists::kLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;
constexpr hn::RebindToSigned<D> di;
constexpr std::size_t kWidth = hn::MaxLanes(d);
constexpr std::size_t kGroup = CutLists::kLanes;
// Lower bound on a length that is a divisor, mm.
constexpr float kTiny_mm = 1e-6f;

HWY_INLINE V constant(float value) {
  return hn::Set(d, value);
}
HWY_INLINE V squared(V v) {
  return hn::Mul(v, v);
}

HWY_INLINE V density(const CutProfile& profile, V t) {
  const V within = hn::Add(constant(profile.isovalue), hn::Mul(constant(profile.per_voxel), t));
  const V beyond = hn::Mul(constant(profile.beyond_per_voxel), hn::Max(hn::Zero(d), hn::Sub(t, constant(1))));
  return hn::Max(constant(profile.surroundings), hn::Add(within, beyond));
}

// Distance from the centre of the half ball that cuts the voxel; `moved` is 0 for the trailing half.
HWY_INLINE V distance(V distance2, V along, V moved) {
  const V twice = hn::Mul(hn::Add(along, along), moved);
  return hn::Sqrt(hn::Max(hn::Add(hn::Sub(distance2, twice), squared(moved)), constant(kTiny_mm * kTiny_mm)));
}

HWY_INLINE V voxels_per_mm(const CutKernelBall& ball, V x, V y, V z, V distance2) {
  if (ball.cubic) return constant(1 / ball.spacing[0]);
  const V across = hn::Add(
      hn::Add(squared(hn::Mul(x, constant(ball.spacing[0]))), squared(hn::Mul(y, constant(ball.spacing[1])))),
      squared(hn::Mul(z, constant(ball.spacing[2]))));
  return hn::Sqrt(hn::Div(distance2, hn::Max(across, constant(kTiny_mm * kTiny_mm))));
}

unsigned GatherPiece(const CutPiece& piece, const CutKernelBall& ball, const CutProfile& profile,
                     float max_ahead, CutLists& lists) {
  unsigned denser = 0;
  const V y = constant(piece.y), z = constant(piece.z);
  const V across = hn::Add(squared(y), squared(z));
  const V along_across = hn::Add(hn::Mul(y, constant(ball.ahead[1])), hn::Mul(z, constant(ball.ahead[2])));
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(piece.bits >> lane)};
    const V before = hn::LoadU(d, piece.densities + lane);
    const M bone = hn::And(hn::LoadMaskBits(d, bits), hn::Gt(before, constant(profile.surroundings)));
    denser |= bits_of(d, bone) << lane;
    const V x = hn::LoadU(d, piece.x + lane);
    const V distance2 = hn::Add(squared(x), across);
    const V along = hn::Add(hn::Mul(x, constant(ball.ahead[0])), along_across);
    const V moved = hn::IfThenElseZero(hn::Gt(along, hn::Zero(d)), constant(max_ahead));
    const V per_mm = voxels_per_mm(ball, x, y, z, distance2);
    const V t = hn::Mul(hn::Sub(distance(distance2, along, moved), constant(ball.radius)), per_mm);
    const M lowered = hn::And(bone, hn::Gt(before, density(profile, t)));
    if (hn::AllFalse(d, lowered)) continue;
    const std::size_t n = lists.size;
    const CompressLanes<D> to_front(d, lowered);
    hn::StoreU(to_front(distance2), d, &lists.distance2_mm2[n]);
    hn::StoreU(to_front(along), d, &lists.ahead_mm[n]);
    hn::StoreU(to_front(per_mm), d, &lists.voxels_per_mm[n]);
    hn::StoreU(to_front(before), d, &lists.before[n]);
    hn::StoreU(to_front(hn::Iota(di, piece.column + static_cast<int>(lane))), di, &lists.columns[n]);
    lists.size += hn::CountTrue(d, lowered);
  }
  return denser;
}

// For a group of list entries: whether the leading half cuts them, and the density that it leaves.
struct Cut {
  M leads;
  V along, moved, from_centre, per_mm, t, density;
};
HWY_INLINE Cut cut(const CutLists& lists, std::size_t n, float radius, const CutProfile& profile,
                   float ahead) {
  Cut c;
  c.along = hn::LoadU(d, &lists.ahead_mm[n]);
  c.leads = hn::Gt(c.along, hn::Zero(d));
  c.moved = hn::IfThenElseZero(c.leads, constant(ahead));
  c.per_mm = hn::LoadU(d, &lists.voxels_per_mm[n]);
  c.from_centre = distance(hn::LoadU(d, &lists.distance2_mm2[n]), c.along, c.moved);
  c.t = hn::Mul(hn::Sub(c.from_centre, constant(radius)), c.per_mm);
  c.density = density(profile, c.t);
  return c;
}

void SumDrops(const CutLists& lists, std::size_t begin, std::size_t end, float radius,
              const CutProfile& profile, float ahead, CutSums& sums) {
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    V leading = hn::Zero(d), slope = hn::Zero(d), trailing = hn::Zero(d);
    for (std::size_t n = begin + lane; n < end; n += kGroup) {
      const Cut c = cut(lists, n, radius, profile, ahead);
      const V drop = hn::Max(hn::Sub(hn::LoadU(d, &lists.before[n]), c.density), hn::Zero(d));
      leading = hn::Add(leading, hn::IfThenElseZero(c.leads, drop));
      trailing = hn::Add(trailing, hn::IfThenZeroElse(c.leads, drop));
      const M grows = hn::And(hn::And(c.leads, hn::Gt(drop, hn::Zero(d))),
                              hn::Gt(c.density, constant(profile.surroundings)));
      const V per_voxel =
          hn::Add(constant(profile.per_voxel),
                  hn::IfThenElseZero(hn::Gt(c.t, constant(1)), constant(profile.beyond_per_voxel)));
      const V per_mm =
          hn::Mul(hn::Mul(per_voxel, c.per_mm), hn::Div(hn::Sub(c.along, c.moved), c.from_centre));
      slope = hn::Add(slope, hn::IfThenElseZero(grows, per_mm));
    }
    hn::Store(leading, d, &sums.leading[lane]);
    hn::Store(slope, d, &sums.slope[lane]);
    hn::Store(trailing, d, &sums.trailing[lane]);
  }
}

void LowerDensities(CutLists& lists, float radius, const CutProfile& profile, float ahead,
                    float leading_share, float trailing_share) {
  const V leading = constant(1 - leading_share), trailing = constant(1 - trailing_share);
  for (std::size_t n = 0; n < lists.size; n += kWidth) {
    const Cut c = cut(lists, n, radius, profile, ahead);
    const V before = hn::LoadU(d, &lists.before[n]);
    const V drop = hn::Max(hn::Sub(before, c.density), hn::Zero(d));
    const V left = hn::Mul(hn::IfThenElse(c.leads, leading, trailing), drop);
    // If the whole drop is applied this is exactly the profile's density, so that the next cut changes
    // nothing.
    hn::StoreU(hn::Min(before, hn::Add(c.density, left)), d, &lists.after[n]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteomill
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteomill {

HWY_EXPORT(GatherPiece);
HWY_EXPORT(SumDrops);
HWY_EXPORT(LowerDensities);

unsigned gather_piece(const CutPiece& piece, const CutKernelBall& ball, const CutProfile& profile,
                      float max_ahead, CutLists& lists) noexcept {
  return HWY_DYNAMIC_DISPATCH(GatherPiece)(piece, ball, profile, max_ahead, lists);
}

void sum_drops(const CutLists& lists, std::size_t begin, std::size_t end, float radius,
               const CutProfile& profile, float ahead, CutSums& sums) noexcept {
  HWY_DYNAMIC_DISPATCH(SumDrops)(lists, begin, end, radius, profile, ahead, sums);
}

void lower_densities(CutLists& lists, float radius, const CutProfile& profile, float ahead,
                     float leading_share, float trailing_share) noexcept {
  HWY_DYNAMIC_DISPATCH(LowerDensities)(lists, radius, profile, ahead, leading_share, trailing_share);
}

void choose_cut_instructions() {
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::int64_t cut_kernel_targets() {
  return HWY_TARGETS;
}

}  // namespace osteomill
#endif
