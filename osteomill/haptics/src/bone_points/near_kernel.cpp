#include "bone_points/near_kernel.h"

#include <bit>

// AVX3_DL and SSSE3 have nothing for us over their neighbours.
#define HWY_DISABLED_TARGETS \
  (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bone_points/near_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "osteomill/base/compress_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteomill {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace lane_moves = osteomill::HWY_NAMESPACE;

// Never hn::MulAdd: it rounds once where the processor can, and twice elsewhere.
using D = hn::CappedTag<float, NearPoints::kLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;
constexpr std::size_t kWidth = hn::MaxLanes(d);
constexpr std::size_t kGroup = NearPoints::kLanes;
// Of a length that is divided by.
constexpr float kTiny_mm = 1e-6f;

HWY_INLINE V constant(float value) {
  return hn::Set(d, value);
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
    if (near.count + PointChunk::kSlots + kGroup > near.room()) {
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
      hn::StoreU(to_front(at.x), d, &near.gathered_x[n]);
      hn::StoreU(to_front(at.y), d, &near.gathered_y[n]);
      hn::StoreU(to_front(at.z), d, &near.gathered_z[n]);
      hn::StoreU(to_front(hn::Load(d, &chunk.area_mm2[slot])), d, &near.area[n]);
      near.count += hn::CountTrue(d, found);
    }
  }
}

// How far beyond the cylinder's nearer end, negative within.
HWY_INLINE V beyond_end(const KernelShape& shape, V z) {
  return hn::Max(hn::Neg(z), hn::Sub(z, constant(shape.cylinder_length)));
}

void GatherNearBall(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                    const KernelShape& shape, float reach, NearPoints& near) {
  const V radius2 = squared(constant(shape.ball_radius + reach));
  gather(
      points, first_chunk, frame, [&](const Vector& at) HWY_ATTR { return hn::Lt(dot(at, at), radius2); },
      near);
}

void GatherNearCylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                        const KernelShape& shape, float reach, float per_lever, NearPoints& near) {
  gather(
      points, first_chunk, frame,
      [&](const Vector& at) HWY_ATTR {
        const V rho2 = hn::Add(squared(at.x), squared(at.y));
        const V lever = hn::Sqrt(hn::Add(rho2, squared(at.z)));
        const V within = hn::Add(constant(reach), hn::Mul(constant(per_lever), lever));
        const M beside = hn::Lt(rho2, squared(hn::Add(constant(shape.cylinder_radius), within)));
        return hn::And(beside, hn::And(hn::Gt(at.z, hn::Neg(within)),
                                       hn::Lt(at.z, hn::Add(constant(shape.cylinder_length), within))));
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

// Barrier::at, times the area.
struct BarrierLaw {
  float width, pressure;

  explicit BarrierLaw(const Barrier& barrier)
      : width(static_cast<float>(barrier.width_mm)),
        pressure(static_cast<float>(barrier.pressure_N_per_mm2)) {}
  HWY_INLINE V reach() const { return constant(width); }
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

template <int kSums>
struct Sums {
  V at[static_cast<std::size_t>(kSums)];
  HWY_INLINE void load(const float (&from)[kSums][kGroup], std::size_t lane) {
    for (std::size_t n = 0; n < kSums; ++n) at[n] = hn::Load(d, &from[n][lane]);
  }
  HWY_INLINE void store(float (&to)[kSums][kGroup], std::size_t lane) const {
    for (std::size_t n = 0; n < kSums; ++n) hn::Store(at[n], d, &to[n][lane]);
  }
};

HWY_INLINE void store_rows(const Vector& v, std::vector<float>& x, std::vector<float>& y,
                           std::vector<float>& z, std::size_t n) {
  hn::StoreU(v.x, d, &x[n]);
  hn::StoreU(v.y, d, &y[n]);
  hn::StoreU(v.z, d, &z[n]);
}

void SumBall(NearPoints& near, const Frame& moved, const KernelShape& shape, const Barrier& barrier,
             BallLanes& lanes) {
  const BarrierLaw law(barrier);
  std::size_t touching = 0;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    Sums<BallLanes::kSums> s;
    s.load(lanes.sums, lane);
    V nearest = hn::Load(d, &lanes.nearest[lane]);
    for (std::size_t n = lane; n < near.count; n += kGroup) {
      const Vector at = transformed(moved, rows_at(near.gathered_x, near.gathered_y, near.gathered_z, n));
      const V r = hn::Sqrt(dot(at, at));
      const V inverse = hn::Div(constant(1), hn::Max(r, constant(kTiny_mm)));
      const Vector out{hn::Mul(at.x, inverse), hn::Mul(at.y, inverse), hn::Mul(at.z, inverse)};
      const V distance = hn::Sub(r, constant(shape.ball_radius));
      hn::StoreU(distance, d, &near.distance[n]);
      store_rows(out, near.out_x, near.out_y, near.out_z, n);
      nearest = hn::Min(nearest, distance);
      if (hn::AllFalse(d, hn::Lt(distance, law.reach()))) continue;  // adds nothing, to the last bit
      const Push p = law.push(hn::LoadU(d, &near.area[n]), distance);
      touching += hn::CountTrue(d, hn::Gt(p.pressure, hn::Zero(d)));
      const V q = hn::Mul(p.pressure, inverse), m = hn::Add(p.stiffness, q);
      add(s.at[9], p.energy);
      add(s.at[10], q);
      add(s.at[0], hn::Mul(p.pressure, out.x));
      add(s.at[1], hn::Mul(p.pressure, out.y));
      add(s.at[2], hn::Mul(p.pressure, out.z));
      const V mx = hn::Mul(m, out.x), my = hn::Mul(m, out.y);
      add(s.at[3], hn::Mul(mx, out.x));
      add(s.at[4], hn::Mul(mx, out.y));
      add(s.at[5], hn::Mul(mx, out.z));
      add(s.at[6], hn::Mul(my, out.y));
      add(s.at[7], hn::Mul(my, out.z));
      add(s.at[8], product(m, out.z, out.z));
    }
    s.store(lanes.sums, lane);
    hn::Store(nearest, d, &lanes.nearest[lane]);
  }
  lanes.touching += static_cast<int>(touching);
}

HWY_INLINE void list_at_end(NearPoints& near, M at_end, std::size_t n) {
  for (unsigned bits = lane_moves::bits_of(d, at_end) & ((1u << kWidth) - 1u); bits != 0; bits &= bits - 1) {
    near.at_end[near.at_end_count++] =
        static_cast<std::uint32_t>(n) + static_cast<std::uint32_t>(std::countr_zero(bits));
  }
}

void SumSide(NearPoints& near, const Frame& moved, const KernelShape& shape, const Barrier& barrier,
             SideLanes& lanes) {
  const BarrierLaw law(barrier);
  std::size_t touching = 0;
  near.at_end_count = 0;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    Sums<SideLanes::kSums> s;
    s.load(lanes.sums, lane);
    V nearest = hn::Load(d, &lanes.nearest[lane]);
    for (std::size_t n = lane; n < near.count; n += kGroup) {
      const Vector at = transformed(moved, rows_at(near.gathered_x, near.gathered_y, near.gathered_z, n));
      const V rho = hn::Sqrt(hn::Add(squared(at.x), squared(at.y)));
      const V inverse = hn::Div(constant(1), hn::Max(rho, constant(kTiny_mm)));
      const Vector out{hn::Mul(at.x, inverse), hn::Mul(at.y, inverse), hn::Zero(d)};
      const V beyond_side = hn::Sub(rho, constant(shape.cylinder_radius));
      const M at_end = hn::Gt(beyond_end(shape, at.z), hn::Min(hn::Zero(d), beyond_side));
      const V distance = hn::IfThenElse(at_end, constant(PointChunk::kFarAway_mm), beyond_side);
      store_rows(at, near.x, near.y, near.z, n);
      hn::StoreU(distance, d, &near.distance[n]);
      store_rows(out, near.out_x, near.out_y, near.out_z, n);
      nearest = hn::Min(nearest, distance);
      if (!hn::AllFalse(d, at_end)) list_at_end(near, at_end, n);
      if (hn::AllFalse(d, hn::Lt(distance, law.reach()))) continue;  // adds nothing, to the last bit
      const Push p = law.push(hn::LoadU(d, &near.area[n]), distance);
      touching += hn::CountTrue(d, hn::Gt(p.pressure, hn::Zero(d)));
      const V pu = hn::Mul(p.pressure, out.x), pv = hn::Mul(p.pressure, out.y);
      const V q = hn::Mul(p.pressure, inverse), qz = hn::Mul(q, at.z), m = hn::Add(p.stiffness, q);
      add(s.at[13], p.energy);
      add(s.at[14], q);
      add(s.at[15], qz);
      add(s.at[16], hn::Mul(qz, at.z));
      add(s.at[17], product(pu, out.x, rho));
      add(s.at[18], product(pu, out.y, rho));
      add(s.at[19], product(pv, out.y, rho));
      add(s.at[0], pu);
      add(s.at[1], pv);
      add(s.at[2], hn::Mul(pu, at.z));
      add(s.at[3], hn::Mul(pv, at.z));
      const V mu = hn::Mul(m, out.x), mv = hn::Mul(m, out.y);
      const V uu = hn::Mul(mu, out.x), uv = hn::Mul(mu, out.y), vv = hn::Mul(mv, out.y);
      add(s.at[4], uu);
      add(s.at[5], uv);
      add(s.at[6], vv);
      const V uuz = hn::Mul(uu, at.z), uvz = hn::Mul(uv, at.z), vvz = hn::Mul(vv, at.z);
      add(s.at[7], uuz);
      add(s.at[8], uvz);
      add(s.at[9], vvz);
      add(s.at[10], hn::Mul(uuz, at.z));
      add(s.at[11], hn::Mul(uvz, at.z));
      add(s.at[12], hn::Mul(vvz, at.z));
    }
    s.store(lanes.sums, lane);
    hn::Store(nearest, d, &lanes.nearest[lane]);
  }
  lanes.touching += static_cast<int>(touching);
}

// `use` of every group of points.
template <typename Use>
HWY_INLINE float max_use(const NearPoints& near, float min_distance, const Use& use) {
  V max = hn::Zero(d);
  for (std::size_t n = 0; n < near.count; n += kWidth) {
    const V distance = hn::Max(hn::LoadU(d, &near.distance[n]), constant(min_distance));
    const Vector out{hn::LoadU(d, &near.out_x[n]), hn::LoadU(d, &near.out_y[n]),
                     hn::LoadU(d, &near.out_z[n])};
    max = hn::Max(max, hn::Div(use(n, out), distance));
  }
  return hn::GetLane(hn::MaxOfLanes(d, max));
}

float GreatestUseByBall(const NearPoints& near, const float (&delta)[3], float min_distance) {
  const Vector move{constant(delta[0]), constant(delta[1]), constant(delta[2])};
  return max_use(near, min_distance, [&](std::size_t, const Vector& out) HWY_ATTR { return dot(out, move); });
}

// The move as delta (3) and omega (3), then |omega| |delta| and |omega|^2 / 2.
float GreatestUseByCylinder(const NearPoints& near, const float (&move)[8], float min_distance) {
  return max_use(near, min_distance, [&](std::size_t n, const Vector& out) HWY_ATTR {
    const V x = hn::LoadU(d, &near.x[n]), y = hn::LoadU(d, &near.y[n]), z = hn::LoadU(d, &near.z[n]);
    const V wx = constant(move[3]), wy = constant(move[4]), wz = constant(move[5]);
    const Vector by{hn::Add(constant(move[0]), hn::Sub(hn::Mul(wy, z), hn::Mul(wz, y))),
                    hn::Add(constant(move[1]), hn::Sub(hn::Mul(wz, x), hn::Mul(wx, z))),
                    hn::Add(constant(move[2]), hn::Sub(hn::Mul(wx, y), hn::Mul(wy, x)))};
    const V lever = hn::Sqrt(hn::Add(hn::Add(squared(x), squared(y)), squared(z)));
    return hn::Add(dot(out, by), hn::Add(constant(move[6]), hn::Mul(constant(move[7]), lever)));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace osteomill
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteomill {

HWY_EXPORT(GatherNearBall);
HWY_EXPORT(GatherNearCylinder);
HWY_EXPORT(SumBall);
HWY_EXPORT(SumSide);
HWY_EXPORT(GreatestUseByBall);
HWY_EXPORT(GreatestUseByCylinder);

namespace {

KernelShape kernel_shape(const Cores& cores) {
  return {static_cast<float>(cores.ball_radius_mm), static_cast<float>(cores.cylinder_radius_mm),
          static_cast<float>(cores.cylinder_length_mm)};
}

}  // namespace

void gather_near_ball(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                      const Cores& cores, const Reach& reach, NearPoints& near) noexcept {
  HWY_DYNAMIC_DISPATCH(GatherNearBall)
  (points, first_chunk, frame, kernel_shape(cores), static_cast<float>(reach.near_mm), near);
}

void gather_near_cylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                          const Cores& cores, const Reach& reach, NearPoints& near) noexcept {
  HWY_DYNAMIC_DISPATCH(GatherNearCylinder)
  (points, first_chunk, frame, kernel_shape(cores), static_cast<float>(reach.near_mm),
   static_cast<float>(reach.per_lever), near);
}

void sum_ball(NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              BallLanes& lanes) noexcept {
  HWY_DYNAMIC_DISPATCH(SumBall)(near, moved, kernel_shape(cores), barrier, lanes);
}

void sum_side(NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              SideLanes& lanes) noexcept {
  HWY_DYNAMIC_DISPATCH(SumSide)(near, moved, kernel_shape(cores), barrier, lanes);
}

double max_use_by_ball(const NearPoints& near, const MoveT& move, double min_distance_mm) noexcept {
  const Eigen::Vector3f delta = move.delta_mm.cast<float>();
  return static_cast<double>(HWY_DYNAMIC_DISPATCH(GreatestUseByBall)(near, {delta.x(), delta.y(), delta.z()},
                                                                     static_cast<float>(min_distance_mm)));
}

double max_use_by_cylinder(const NearPoints& near, const MoveT& move, double min_distance_mm) noexcept {
  const Eigen::Vector3f delta = move.delta_mm.cast<float>(), omega = move.omega_rad.cast<float>();
  const double turn = move.omega_rad.norm();
  return static_cast<double>(HWY_DYNAMIC_DISPATCH(GreatestUseByCylinder)(
      near,
      {delta.x(), delta.y(), delta.z(), omega.x(), omega.y(), omega.z(),
       static_cast<float>(turn * move.delta_mm.norm()), static_cast<float>(0.5 * turn * turn)},
      static_cast<float>(min_distance_mm)));
}

std::int64_t near_kernel_targets() {
  return HWY_TARGETS;
}

}  // namespace osteomill
#endif
