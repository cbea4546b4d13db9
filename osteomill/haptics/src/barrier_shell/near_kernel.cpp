#include "barrier_shell/near_kernel.h"

#include <bit>

// AVX3_DL and SSSE3 bring no gain over their neighbours.
#define HWY_DISABLED_TARGETS \
  (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "barrier_shell/near_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "osteomill/base/compress_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteomill::barrier_shell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace lane_moves = osteomill::HWY_NAMESPACE;

// Never uses hn::MulAdd, which rounds once with FMA and twice without.
using D = hn::CappedTag<float, NearPoints::kLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;
constexpr std::size_t kWidth = hn::MaxLanes(d);
constexpr std::size_t kGroup = NearPoints::kLanes;
// Lower bound on a length used as a divisor, mm.
constexpr float kTiny_mm = 1e-6f;

template <typename Number>
HWY_INLINE V constant(Number value) {
  return hn::Set(d, static_cast<float>(value));
}
HWY_INLINE V product(V a, V b) {
  return hn::Mul(a, b);
}
template <typename... Rest>
HWY_INLINE V product(V a, V b, Rest... rest) {
  return product(hn::Mul(a, b), rest...);
}
HWY_INLINE void add(V& sum, V value) {
  sum = hn::Add(sum, value);
}

struct Vector {
  V x, y, z;
};

HWY_INLINE V coordinate(const Frame& frame, int row, const Vector& p) {
  return hn::Add(hn::Add(hn::Add(constant(frame.origin[row]), hn::Mul(constant(frame.turn[row][0]), p.x)),
                         hn::Mul(constant(frame.turn[row][1]), p.y)),
                 hn::Mul(constant(frame.turn[row][2]), p.z));
}
HWY_INLINE Vector transformed(const Frame& frame, const Vector& p) {
  return {coordinate(frame, 0, p), coordinate(frame, 1, p), coordinate(frame, 2, p)};
}
HWY_INLINE V dot(const Vector& a, const Vector& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V squared(V v) {
  return hn::Mul(v, v);
}

template <typename IsNear>
HWY_INLINE void gather(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                       const IsNear& is_near, NearPoints& near) {
  for (std::uint32_t c = first_chunk; c != BrickPoints::kNoChunk; c = points.next_chunk(c)) {
    const PointChunk& chunk = points.chunk(c);
    if (near.count + PointChunk::kSlots + kGroup > near.capacity()) {
      near.overflowed = true;
      return;
    }
    for (std::size_t slot = 0; slot < PointChunk::kSlots; slot += kWidth) {
      const Vector at = transformed(frame, {hn::Load(d, &chunk.x_mm[slot]), hn::Load(d, &chunk.y_mm[slot]),
                                            hn::Load(d, &chunk.z_mm[slot])});
      const M found = is_near(at);
      if (hn::AllFalse(d, found)) continue;
      const std::size_t n = near.count;
      const lane_moves::CompressLanes<D> to_front(d, found);
      hn::StoreU(to_front(at.x), d, &near.x[n]);
      hn::StoreU(to_front(at.y), d, &near.y[n]);
      hn::StoreU(to_front(at.z), d, &near.z[n]);
      hn::StoreU(to_front(hn::Load(d, &chunk.area_mm2[slot])), d, &near.area[n]);
      near.count += hn::CountTrue(d, found);
    }
  }
}

// Returns the distance beyond the cylinder's nearer end, negative inside.
HWY_INLINE V beyond_end(V z, V length) {
  return hn::Max(hn::Neg(z), hn::Sub(z, length));
}

void GatherNearBall(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                    const GatherRegion& region, NearPoints& near) {
  const V radius2 = squared(hn::Add(constant(region.cores.ball_radius_mm), constant(region.near_mm)));
  gather(
      points, first_chunk, frame, [&](const Vector& at) HWY_ATTR { return hn::Lt(dot(at, at), radius2); },
      near);
}

void GatherNearCylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                        const GatherRegion& region, NearPoints& near) {
  const V near_mm = constant(region.near_mm), per_lever = constant(region.per_lever);
  const V radius = constant(region.cores.cylinder_radius_mm),
          length = constant(region.cores.cylinder_length_mm);
  gather(
      points, first_chunk, frame,
      [&](const Vector& at) HWY_ATTR {
        const V rho2 = hn::Add(squared(at.x), squared(at.y));
        const V lever = hn::Sqrt(hn::Add(rho2, squared(at.z)));
        const V within = hn::Add(near_mm, hn::Mul(per_lever, lever));
        const M beside = hn::Lt(rho2, squared(hn::Add(radius, within)));
        return hn::And(beside, hn::And(hn::Gt(at.z, hn::Neg(within)), hn::Lt(at.z, hn::Add(length, within))));
      },
      near);
}

HWY_INLINE Vector rows_at(const std::vector<float>& x, const std::vector<float>& y,
                          const std::vector<float>& z, std::size_t n) {
  return {hn::LoadU(d, &x[n]), hn::LoadU(d, &y[n]), hn::LoadU(d, &z[n])};
}

struct Push {
  V energy, pressure, stiffness;
};

// Evaluates Barrier::at, times the area.
struct BarrierLaw {
  float width, pressure;

  explicit BarrierLaw(const Barrier& barrier)
      : width(static_cast<float>(barrier.width_mm)),
        pressure(static_cast<float>(barrier.pressure_N_per_mm2)) {}
  HWY_INLINE V region() const { return constant(width); }
  HWY_INLINE Push push(V area, V distance) const {
    const V one = constant(1), inverse_width = constant(1 / width);
    const V share =
        hn::Max(hn::Mul(distance, inverse_width), constant(static_cast<float>(Barrier::kNearestShare)));
    const V x = hn::Max(hn::Sub(one, share), hn::Zero(d));
    const V inverse = hn::Div(one, share);
    const V a = hn::Mul(area, constant(pressure / 3)), x2 = squared(x);
    const V ax = product(a, x, inverse), inverse2 = squared(inverse);
    return {product(ax, x2, constant(width)), product(a, x2, inverse2, hn::Sub(constant(3), hn::Add(x, x))),
            product(product(ax, inverse2, inverse_width),
                    hn::Add(hn::Sub(constant(6), hn::Mul(constant(6), x)), hn::Add(x2, x2)))};
  }
};

template <typename Name>
struct Sums {
  V at[Lanes<Name>::kSums];

  HWY_INLINE V& operator[](Name name) { return at[static_cast<std::size_t>(name)]; }
  HWY_INLINE void load(const Lanes<Name>& from, std::size_t lane) {
    for (std::size_t n = 0; n < Lanes<Name>::kSums; ++n) at[n] = hn::Load(d, &from.sums[n][lane]);
  }
  HWY_INLINE void store(Lanes<Name>& to, std::size_t lane) const {
    for (std::size_t n = 0; n < Lanes<Name>::kSums; ++n) hn::Store(at[n], d, &to.sums[n][lane]);
  }
};

HWY_INLINE void store_rows(const Vector& v, std::vector<float>& x, std::vector<float>& y,
                           std::vector<float>& z, std::size_t n) {
  hn::StoreU(v.x, d, &x[n]);
  hn::StoreU(v.y, d, &y[n]);
  hn::StoreU(v.z, d, &z[n]);
}

void SumBall(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
             Lanes<BallSum>& lanes, MeasuredPoints& measured) {
  using S = BallSum;
  const BarrierLaw law(barrier);
  const V ball_radius = constant(cores.ball_radius_mm);
  std::size_t touching = 0;
  measured.count = near.count;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    Sums<BallSum> s;
    s.load(lanes, lane);
    V nearest = hn::Load(d, &lanes.nearest[lane]);
    for (std::size_t n = lane; n < near.count; n += kGroup) {
      const Vector at = transformed(moved, rows_at(near.x, near.y, near.z, n));
      const V r = hn::Sqrt(dot(at, at));
      const V inverse = hn::Div(constant(1), hn::Max(r, constant(kTiny_mm)));
      const Vector out{hn::Mul(at.x, inverse), hn::Mul(at.y, inverse), hn::Mul(at.z, inverse)};
      const V distance = hn::Sub(r, ball_radius);
      hn::StoreU(distance, d, &measured.distance[n]);
      store_rows(out, measured.out_x, measured.out_y, measured.out_z, n);
      nearest = hn::Min(nearest, distance);
      if (hn::AllFalse(d, hn::Lt(distance, law.region()))) continue;  // would add exactly zero
      const Push p = law.push(hn::LoadU(d, &near.area[n]), distance);
      touching += hn::CountTrue(d, hn::Gt(p.pressure, hn::Zero(d)));
      const V q = hn::Mul(p.pressure, inverse), m = hn::Add(p.stiffness, q);
      add(s[S::energy], p.energy);
      add(s[S::q], q);
      add(s[S::px], hn::Mul(p.pressure, out.x));
      add(s[S::py], hn::Mul(p.pressure, out.y));
      add(s[S::pz], hn::Mul(p.pressure, out.z));
      const V mx = hn::Mul(m, out.x), my = hn::Mul(m, out.y);
      add(s[S::mxx], hn::Mul(mx, out.x));
      add(s[S::mxy], hn::Mul(mx, out.y));
      add(s[S::mxz], hn::Mul(mx, out.z));
      add(s[S::myy], hn::Mul(my, out.y));
      add(s[S::myz], hn::Mul(my, out.z));
      add(s[S::mzz], product(m, out.z, out.z));
    }
    s.store(lanes, lane);
    hn::Store(nearest, d, &lanes.nearest[lane]);
  }
  lanes.touching += static_cast<int>(touching);
}

HWY_INLINE void list_at_end(MeasuredPoints& measured, M at_end, std::size_t n) {
  for (unsigned bits = lane_moves::bits_of(d, at_end) & ((1u << kWidth) - 1u); bits != 0; bits &= bits - 1) {
    measured.at_end[measured.at_end_count++] =
        static_cast<std::uint32_t>(n) + static_cast<std::uint32_t>(std::countr_zero(bits));
  }
}

void SumSide(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
             Lanes<SideSum>& lanes, MeasuredPoints& measured) {
  using S = SideSum;
  const BarrierLaw law(barrier);
  const V radius = constant(cores.cylinder_radius_mm), length = constant(cores.cylinder_length_mm);
  std::size_t touching = 0;
  measured.count = near.count;
  measured.at_end_count = 0;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    Sums<SideSum> s;
    s.load(lanes, lane);
    V nearest = hn::Load(d, &lanes.nearest[lane]);
    for (std::size_t n = lane; n < near.count; n += kGroup) {
      const Vector at = transformed(moved, rows_at(near.x, near.y, near.z, n));
      const V rho = hn::Sqrt(hn::Add(squared(at.x), squared(at.y)));
      const V inverse = hn::Div(constant(1), hn::Max(rho, constant(kTiny_mm)));
      const Vector out{hn::Mul(at.x, inverse), hn::Mul(at.y, inverse), hn::Zero(d)};
      const V beyond_side = hn::Sub(rho, radius);
      const M at_end = hn::Gt(beyond_end(at.z, length), hn::Min(hn::Zero(d), beyond_side));
      const V distance = hn::IfThenElse(at_end, constant(PointChunk::kFarAway_mm), beyond_side);
      store_rows(at, measured.x, measured.y, measured.z, n);
      hn::StoreU(distance, d, &measured.distance[n]);
      store_rows(out, measured.out_x, measured.out_y, measured.out_z, n);
      nearest = hn::Min(nearest, distance);
      if (!hn::AllFalse(d, at_end)) list_at_end(measured, at_end, n);
      if (hn::AllFalse(d, hn::Lt(distance, law.region()))) continue;  // would add exactly zero
      const Push p = law.push(hn::LoadU(d, &near.area[n]), distance);
      touching += hn::CountTrue(d, hn::Gt(p.pressure, hn::Zero(d)));
      const V pu = hn::Mul(p.pressure, out.x), pv = hn::Mul(p.pressure, out.y);
      const V q = hn::Mul(p.pressure, inverse), qz = hn::Mul(q, at.z), m = hn::Add(p.stiffness, q);
      add(s[S::energy], p.energy);
      add(s[S::q], q);
      add(s[S::qz], qz);
      add(s[S::qzz], hn::Mul(qz, at.z));
      add(s[S::p_rho_uu], product(pu, out.x, rho));
      add(s[S::p_rho_uv], product(pu, out.y, rho));
      add(s[S::p_rho_vv], product(pv, out.y, rho));
      add(s[S::pu], pu);
      add(s[S::pv], pv);
      add(s[S::pzu], hn::Mul(pu, at.z));
      add(s[S::pzv], hn::Mul(pv, at.z));
      const V mu = hn::Mul(m, out.x), mv = hn::Mul(m, out.y);
      const V uu = hn::Mul(mu, out.x), uv = hn::Mul(mu, out.y), vv = hn::Mul(mv, out.y);
      add(s[S::muu], uu);
      add(s[S::muv], uv);
      add(s[S::mvv], vv);
      const V uuz = hn::Mul(uu, at.z), uvz = hn::Mul(uv, at.z), vvz = hn::Mul(vv, at.z);
      add(s[S::mzuu], uuz);
      add(s[S::mzuv], uvz);
      add(s[S::mzvv], vvz);
      add(s[S::mzzuu], hn::Mul(uuz, at.z));
      add(s[S::mzzuv], hn::Mul(uvz, at.z));
      add(s[S::mzzvv], hn::Mul(vvz, at.z));
    }
    s.store(lanes, lane);
    hn::Store(nearest, d, &lanes.nearest[lane]);
  }
  lanes.touching += static_cast<int>(touching);
}

// Returns the largest `use(n, outward)` / distance, where `use` handles a vector of points starting at n.
template <typename Use>
HWY_INLINE float max_use(const MeasuredPoints& measured, float min_distance, const Use& use) {
  V max = hn::Zero(d);
  for (std::size_t n = 0; n < measured.count; n += kWidth) {
    const V distance = hn::Max(hn::LoadU(d, &measured.distance[n]), constant(min_distance));
    const Vector out{hn::LoadU(d, &measured.out_x[n]), hn::LoadU(d, &measured.out_y[n]),
                     hn::LoadU(d, &measured.out_z[n])};
    max = hn::Max(max, hn::Div(use(n, out), distance));
  }
  return hn::GetLane(hn::MaxOfLanes(d, max));
}

float GreatestUseByBall(const MeasuredPoints& measured, const float (&delta)[3], float min_distance) {
  const Vector move{constant(delta[0]), constant(delta[1]), constant(delta[2])};
  return max_use(measured, min_distance,
                 [&](std::size_t, const Vector& out) HWY_ATTR { return dot(out, move); });
}

// `move` holds delta (3), omega (3), |omega| |delta| and |omega|^2 / 2.
float GreatestUseByCylinder(const MeasuredPoints& measured, const float (&move)[8], float min_distance) {
  return max_use(measured, min_distance, [&](std::size_t n, const Vector& out) HWY_ATTR {
    const V x = hn::LoadU(d, &measured.x[n]), y = hn::LoadU(d, &measured.y[n]),
            z = hn::LoadU(d, &measured.z[n]);
    const V wx = constant(move[3]), wy = constant(move[4]), wz = constant(move[5]);
    const Vector by{hn::Add(constant(move[0]), hn::Sub(hn::Mul(wy, z), hn::Mul(wz, y))),
                    hn::Add(constant(move[1]), hn::Sub(hn::Mul(wz, x), hn::Mul(wx, z))),
                    hn::Add(constant(move[2]), hn::Sub(hn::Mul(wx, y), hn::Mul(wy, x)))};
    const V lever = hn::Sqrt(hn::Add(hn::Add(squared(x), squared(y)), squared(z)));
    return hn::Add(dot(out, by), hn::Add(constant(move[6]), hn::Mul(constant(move[7]), lever)));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace osteomill::barrier_shell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteomill::barrier_shell {

HWY_EXPORT(GatherNearBall);
HWY_EXPORT(GatherNearCylinder);
HWY_EXPORT(SumBall);
HWY_EXPORT(SumSide);
HWY_EXPORT(GreatestUseByBall);
HWY_EXPORT(GreatestUseByCylinder);

void gather_near_ball(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                      const GatherRegion& region, NearPoints& near) noexcept {
  HWY_DYNAMIC_DISPATCH(GatherNearBall)(points, first_chunk, frame, region, near);
}

void gather_near_cylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                          const GatherRegion& region, NearPoints& near) noexcept {
  HWY_DYNAMIC_DISPATCH(GatherNearCylinder)(points, first_chunk, frame, region, near);
}

void sum_ball(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              Lanes<BallSum>& lanes, MeasuredPoints& measured) noexcept {
  HWY_DYNAMIC_DISPATCH(SumBall)(near, moved, cores, barrier, lanes, measured);
}

void sum_side(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              Lanes<SideSum>& lanes, MeasuredPoints& measured) noexcept {
  HWY_DYNAMIC_DISPATCH(SumSide)(near, moved, cores, barrier, lanes, measured);
}

double max_use_by_ball(const MeasuredPoints& measured, const Vector6& move_T,
                       double min_distance_mm) noexcept {
  const Eigen::Vector3f delta = move_T.head<3>().cast<float>();
  return static_cast<double>(HWY_DYNAMIC_DISPATCH(GreatestUseByBall)(
      measured, {delta.x(), delta.y(), delta.z()}, static_cast<float>(min_distance_mm)));
}

double max_use_by_cylinder(const MeasuredPoints& measured, const Vector6& move_T,
                           double min_distance_mm) noexcept {
  const Vec3 delta_mm = move_T.head<3>(), omega_rad = move_T.tail<3>();
  const Eigen::Vector3f delta = delta_mm.cast<float>(), omega = omega_rad.cast<float>();
  const double turn = omega_rad.norm();
  return static_cast<double>(HWY_DYNAMIC_DISPATCH(GreatestUseByCylinder)(
      measured,
      {delta.x(), delta.y(), delta.z(), omega.x(), omega.y(), omega.z(),
       static_cast<float>(turn * delta_mm.norm()), static_cast<float>(0.5 * turn * turn)},
      static_cast<float>(min_distance_mm)));
}

std::int64_t near_kernel_targets() {
  return HWY_TARGETS;
}

}  // namespace osteomill::barrier_shell
#endif
