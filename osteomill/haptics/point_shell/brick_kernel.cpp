#include "osteomill/haptics/point_shell/brick_kernel.h"

// Sizeless vectors (SVE, RVV) cannot be members, and AVX3_DL and SSSE3 have nothing for us over their
// neighbours.
#define HWY_DISABLED_TARGETS \
  (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "osteomill/haptics/point_shell/brick_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace osteomill::point_shell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Never hn::MulAdd: it rounds once where the processor can, and twice elsewhere.
using D = hn::CappedTag<double, KernelSums::kLanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;
constexpr std::size_t kWidth = hn::MaxLanes(d);
constexpr std::size_t kGroup = KernelSums::kLanes;
using Floats = hn::Rebind<float, D>;

HWY_INLINE V constant(double value) {
  return hn::Set(d, value);
}
HWY_INLINE V load(const float* from) {
  return hn::PromoteTo(d, hn::Load(Floats(), from));
}

// 1 / sqrt(v) to 1e-13, for v within float's range: in single precision, correctly rounded everywhere (as the
// processors' own approximations are not), then one step of Newton's.
HWY_INLINE V inverse_root(V v) {
  const auto f = hn::DemoteTo(Floats(), v);
  const V y = hn::PromoteTo(d, hn::Div(hn::Set(Floats(), 1.0f), hn::Sqrt(f)));
  return hn::Mul(y, hn::Sub(constant(1.5), hn::Mul(hn::Mul(constant(0.5), v), hn::Mul(y, y))));
}

struct Vector {
  V x, y, z;
};

HWY_INLINE V row(const double (&m)[3], const Vector& v) {
  return hn::Add(hn::Add(hn::Mul(constant(m[0]), v.x), hn::Mul(constant(m[1]), v.y)),
                 hn::Mul(constant(m[2]), v.z));
}

struct Push {
  V force;
  V stiffness;
  M touches;
};

// Penalty::push, for lanes in `wanted`; zero in all others. Nearly all patches lie in the tool as a whole,
// and then no root is needed.
HWY_INLINE Push push(const KernelTool& tool, M wanted, V distance, V area, V cosine, double curvature) {
  const V k = hn::Mul(constant(tool.stiffness_N_per_mm3), area);
  const V patch = hn::Min(area, constant(tool.max_patch_mm2));
  const V sine2 = hn::Max(hn::Zero(d), hn::Sub(constant(1), hn::Mul(cosine, cosine)));
  const V spread2 = hn::Mul(hn::Mul(constant(0.25), patch), sine2);
  const V mean = hn::Sub(hn::Neg(distance), hn::Mul(patch, constant(curvature / 24)));
  M touches = hn::And(wanted, hn::Gt(hn::Mul(k, mean), hn::Zero(d)));
  const M in_part = hn::And(wanted, hn::Lt(hn::Mul(mean, mean), spread2));
  V force = hn::Mul(k, mean), stiffness = k;
  if (!hn::AllFalse(d, in_part)) {
    const V inverse = inverse_root(hn::Max(spread2, constant(1e-30)));
    const V spread = hn::Mul(spread2, inverse);
    const V part = hn::Mul(constant(0.5), hn::Mul(hn::Add(mean, spread), inverse));
    const V part_stiffness = hn::Mul(k, part);
    const V part_force = hn::Mul(part_stiffness, hn::Mul(part, spread));
    force = hn::IfThenElse(in_part, part_force, force);
    stiffness = hn::IfThenElse(in_part, part_stiffness, stiffness);
    touches = hn::Or(touches, hn::And(in_part, hn::Gt(part_force, hn::Zero(d))));
  }
  return {hn::IfThenElseZero(touches, force), hn::IfThenElseZero(touches, stiffness), touches};
}

struct SideSums {
  V fu, fw, fzu, fzw, k0, uu0, uw0, k1, uu1, uw1, k2, uu2, uw2;
};
struct SphereSums {
  V fx, fy, fz, xx, xy, xz, yy, yz, zz;
};

HWY_INLINE void add(V& sum, V value) {
  sum = hn::Add(sum, value);
}

HWY_INLINE void add_side(SideSums& s, const Push& p, V u, V w, V z) {
  const V fu = hn::Mul(p.force, u), fw = hn::Mul(p.force, w);
  add(s.fu, fu);
  add(s.fw, fw);
  add(s.fzu, hn::Mul(fu, z));
  add(s.fzw, hn::Mul(fw, z));
  const V ku = hn::Mul(p.stiffness, u);
  const V uu = hn::Mul(ku, u), uw = hn::Mul(ku, w);
  add(s.k0, p.stiffness);
  add(s.uu0, uu);
  add(s.uw0, uw);
  const V k1 = hn::Mul(p.stiffness, z), uu1 = hn::Mul(uu, z), uw1 = hn::Mul(uw, z);
  add(s.k1, k1);
  add(s.uu1, uu1);
  add(s.uw1, uw1);
  add(s.k2, hn::Mul(k1, z));
  add(s.uu2, hn::Mul(uu1, z));
  add(s.uw2, hn::Mul(uw1, z));
}

HWY_INLINE void add_sphere(SphereSums& s, const Push& p, const Vector& n) {
  add(s.fx, hn::Mul(p.force, n.x));
  add(s.fy, hn::Mul(p.force, n.y));
  add(s.fz, hn::Mul(p.force, n.z));
  const V kx = hn::Mul(p.stiffness, n.x), ky = hn::Mul(p.stiffness, n.y), kz = hn::Mul(p.stiffness, n.z);
  add(s.xx, hn::Mul(kx, n.x));
  add(s.xy, hn::Mul(kx, n.y));
  add(s.xz, hn::Mul(kx, n.z));
  add(s.yy, hn::Mul(ky, n.y));
  add(s.yz, hn::Mul(ky, n.z));
  add(s.zz, hn::Mul(kz, n.z));
}

HWY_INLINE SideSums load_side(const KernelSums& sums, std::size_t lane) {
  const auto at = [&](int n) HWY_ATTR { return hn::Load(d, &sums.side[n][lane]); };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9), at(10), at(11), at(12)};
}
HWY_INLINE void store(const SideSums& s, KernelSums& sums, std::size_t lane) {
  const V all[] = {s.fu, s.fw, s.fzu, s.fzw, s.k0, s.uu0, s.uw0, s.k1, s.uu1, s.uw1, s.k2, s.uu2, s.uw2};
  for (int n = 0; n < KernelSums::kSide; ++n) hn::Store(all[n], d, &sums.side[n][lane]);
}
HWY_INLINE SphereSums load_sphere(const KernelSums& sums, std::size_t lane) {
  const auto at = [&](int n) HWY_ATTR { return hn::Load(d, &sums.sphere[n][lane]); };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
}
HWY_INLINE void store(const SphereSums& s, KernelSums& sums, std::size_t lane) {
  const V all[] = {s.fx, s.fy, s.fz, s.xx, s.xy, s.xz, s.yy, s.yz, s.zz};
  for (int n = 0; n < KernelSums::kSphere; ++n) hn::Store(all[n], d, &sums.sphere[n][lane]);
}

// A few points of a chunk, seen from the tool.
struct Points {
  Vector at;
  V radial2;
  V from_centre2;
  V area;
  Vector normal_G;
};

HWY_INLINE Points points_at(const PointChunk& chunk, std::size_t slot, const KernelFrame& frame) {
  Points p;
  const Vector local{load(&chunk.x_mm[slot]), load(&chunk.y_mm[slot]), load(&chunk.z_mm[slot])};
  p.at = {hn::Add(constant(frame.origin_mm[0]), row(frame.turn[0], local)),
          hn::Add(constant(frame.origin_mm[1]), row(frame.turn[1], local)),
          hn::Add(constant(frame.origin_mm[2]), row(frame.turn[2], local))};
  p.radial2 = hn::Add(hn::Mul(p.at.x, p.at.x), hn::Mul(p.at.y, p.at.y));
  p.from_centre2 = hn::Add(p.radial2, hn::Mul(p.at.z, p.at.z));
  p.area = load(&chunk.area_mm2[slot]);
  p.normal_G = {load(&chunk.normal_x[slot]), load(&chunk.normal_y[slot]), load(&chunk.normal_z[slot])};
  return p;
}

// Where a root is not safe to divide by: on the axis and in the centre.
constexpr double kOnAxis_mm2 = 1e-20;

// Which lanes are on which part of the tool; the rest of those that may touch are for the plain way.
struct Parts {
  M side;
  M sphere;
  M rest;
  V side_inverse;
  V sphere_inverse;
};

HWY_INLINE double squared(double value) {
  return value * value;
}

HWY_INLINE Parts parts_of(const Points& p, const KernelTool& tool) {
  const M near_sphere = hn::Lt(p.from_centre2, constant(squared(tool.burr_radius_mm + tool.reach_mm)));
  const M near_side = hn::And(hn::Lt(p.radial2, constant(squared(tool.shaft_radius_mm + tool.reach_mm))),
                              hn::And(hn::Gt(p.at.z, constant(-tool.reach_mm)),
                                      hn::Lt(p.at.z, constant(tool.shaft_length_mm + tool.reach_mm))));
  const M never = hn::Lt(p.radial2, hn::Zero(d));
  Parts parts{never, never, never, p.radial2, p.radial2};
  const bool any_sphere = !hn::AllFalse(d, near_sphere), any_side = !hn::AllFalse(d, near_side);
  const M is_burr = hn::Lt(p.at.z, constant(tool.burr_top_mm));
  const M off_axis = hn::Gt(p.radial2, constant(kOnAxis_mm2));
  if (any_sphere) parts.sphere_inverse = inverse_root(hn::Max(p.from_centre2, constant(kOnAxis_mm2)));
  if (!any_side) {  // beside the shaft the sphere is the nearer
    const M on_sphere = hn::And(near_sphere, off_axis);
    parts.sphere = hn::And(on_sphere, is_burr);
    parts.rest = hn::AndNot(parts.sphere, near_sphere);
    return parts;
  }
  parts.side_inverse = inverse_root(hn::Max(p.radial2, constant(kOnAxis_mm2)));
  const V beyond_side = hn::Sub(hn::Mul(p.radial2, parts.side_inverse), constant(tool.shaft_radius_mm));
  const V beyond_end = hn::IfThenElse(hn::Gt(p.at.z, constant(0.5 * tool.shaft_length_mm)),
                                      hn::Sub(p.at.z, constant(tool.shaft_length_mm)), hn::Neg(p.at.z));
  M on_sphere = never;
  if (any_sphere) {
    const V beyond_burr =
        hn::Sub(hn::Mul(p.from_centre2, parts.sphere_inverse), constant(tool.burr_radius_mm));
    on_sphere = hn::Lt(beyond_burr, hn::Max(beyond_side, beyond_end));
  }
  const M on_side =
      hn::AndNot(on_sphere, hn::And(hn::Gt(beyond_side, beyond_end), hn::Le(beyond_end, hn::Zero(d))));
  parts.sphere = hn::And(hn::And(near_sphere, on_sphere), hn::And(is_burr, off_axis));
  parts.side = hn::And(hn::And(near_side, on_side), hn::AndNot(is_burr, off_axis));
  parts.rest = hn::AndNot(hn::Or(parts.sphere, parts.side), hn::Or(near_sphere, near_side));
  return parts;
}

HWY_INLINE std::uint32_t bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] & ((1u << kWidth) - 1u);
}

// Bit n: whether point n may touch, in single precision, with a margin wider than the rounding.
HWY_INLINE std::uint32_t sift(const PointChunk& chunk, const KernelFrame& frame, const KernelTool& tool) {
  constexpr hn::CappedTag<float, 16> df;
  constexpr std::size_t kFloats = hn::MaxLanes(df);
  constexpr double kRounding_mm = 1e-4;
  const double wider = tool.reach_mm + kRounding_mm;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(df, static_cast<float>(value)); };
  const auto burr2 = set(squared(tool.burr_radius_mm + wider)),
             side2 = set(squared(tool.shaft_radius_mm + wider));
  const auto from = set(-wider), to = set(tool.shaft_length_mm + wider);
  std::uint32_t found = 0;
  for (std::size_t n = 0; n < PointChunk::kSlots; n += kFloats) {
    const auto cx = hn::Load(df, &chunk.x_mm[n]), cy = hn::Load(df, &chunk.y_mm[n]),
               cz = hn::Load(df, &chunk.z_mm[n]);
    const auto coordinate = [&](int r) HWY_ATTR {
      return hn::Add(hn::Add(hn::Add(set(frame.origin_mm[r]), hn::Mul(set(frame.turn[r][0]), cx)),
                             hn::Mul(set(frame.turn[r][1]), cy)),
                     hn::Mul(set(frame.turn[r][2]), cz));
    };
    const auto x = coordinate(0), y = coordinate(1), z = coordinate(2);
    const auto radial2 = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
    const auto in_burr = hn::Lt(hn::Add(radial2, hn::Mul(z, z)), burr2);
    const auto in_shaft = hn::And(hn::Lt(radial2, side2), hn::And(hn::Gt(z, from), hn::Lt(z, to)));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(df, hn::Or(in_burr, in_shaft), bytes);
    const std::uint32_t bits =
        (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) & ((1u << kFloats) - 1u);
    found |= bits << n;
  }
  return found;
}

HWY_INLINE std::size_t touch_side(const Points& p, M wanted, V inverse, const KernelFrame& frame,
                                  const KernelTool& tool, SideSums& sums) {
  const V u = hn::Mul(p.at.x, inverse), w = hn::Mul(p.at.y, inverse);
  const V distance = hn::Sub(hn::Mul(p.radial2, inverse), constant(tool.shaft_radius_mm));
  const V cosine =
      hn::Add(hn::Mul(u, row(frame.turn[0], p.normal_G)), hn::Mul(w, row(frame.turn[1], p.normal_G)));
  const Push found = push(tool, wanted, distance, p.area, cosine, 1 / tool.shaft_radius_mm);
  if (hn::AllFalse(d, found.touches)) return 0;
  add_side(sums, found, u, w, p.at.z);
  return hn::CountTrue(d, found.touches);
}

HWY_INLINE std::size_t touch_sphere(const Points& p, M wanted, V inverse, const KernelFrame& frame,
                                    const KernelTool& tool, SphereSums& sums) {
  const Vector n{hn::Mul(p.at.x, inverse), hn::Mul(p.at.y, inverse), hn::Mul(p.at.z, inverse)};
  const V distance = hn::Sub(hn::Mul(p.from_centre2, inverse), constant(tool.burr_radius_mm));
  const V cosine = hn::Add(
      hn::Add(hn::Mul(n.x, row(frame.turn[0], p.normal_G)), hn::Mul(n.y, row(frame.turn[1], p.normal_G))),
      hn::Mul(n.z, row(frame.turn[2], p.normal_G)));
  const Push found = push(tool, wanted, distance, p.area, cosine, 2 / tool.burr_radius_mm);
  if (hn::AllFalse(d, found.touches)) return 0;
  add_sphere(sums, found, n);
  return hn::CountTrue(d, found.touches);
}

constexpr std::uint32_t kWidthBits = (1u << kWidth) - 1u;

std::uint32_t AddPoints(const PointChunk& chunk, const KernelFrame& frame, const KernelTool& tool,
                        KernelSums& sums) {
  const std::uint32_t near = sift(chunk, frame, tool);
  if (near == 0) return 0;
  std::uint32_t rest = 0;
  std::size_t touching = 0;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    SideSums side = load_side(sums, lane);
    SphereSums sphere = load_sphere(sums, lane);
    for (std::size_t slot = lane; slot < PointChunk::kSlots; slot += kGroup) {
      if ((near >> slot & kWidthBits) == 0) continue;
      const Points p = points_at(chunk, slot, frame);
      const Parts parts = parts_of(p, tool);
      rest |= bits_of(parts.rest) << slot;
      if (!hn::AllFalse(d, parts.side)) {
        touching += touch_side(p, parts.side, parts.side_inverse, frame, tool, side);
      }
      if (!hn::AllFalse(d, parts.sphere)) {
        touching += touch_sphere(p, parts.sphere, parts.sphere_inverse, frame, tool, sphere);
      }
    }
    store(side, sums, lane);
    store(sphere, sums, lane);
  }
  sums.touching += static_cast<int>(touching);
  return rest;
}

void AddSidePoints(const BrickPoints& points, std::uint32_t first_chunk, const KernelFrame& frame,
                   const KernelTool& tool, KernelSums& sums) {
  std::size_t touching = 0;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    SideSums side = load_side(sums, lane);
    for (std::uint32_t c = first_chunk; c != BrickPoints::kNoChunk; c = points.next_chunk(c)) {
      const PointChunk& chunk = points.chunk(c);
      const std::uint32_t near = sift(chunk, frame, tool);
      for (std::size_t slot = lane; slot < PointChunk::kSlots; slot += kGroup) {
        if ((near >> slot & kWidthBits) == 0) continue;
        const Points p = points_at(chunk, slot, frame);
        const V inverse = inverse_root(hn::Max(p.radial2, constant(kOnAxis_mm2)));
        touching += touch_side(p, hn::Gt(p.area, hn::Zero(d)), inverse, frame, tool, side);
      }
    }
    store(side, sums, lane);
  }
  sums.touching += static_cast<int>(touching);
}

void AddSpherePoints(const BrickPoints& points, std::uint32_t first_chunk, const KernelFrame& frame,
                     const KernelTool& tool, KernelSums& sums) {
  std::size_t touching = 0;
  for (std::size_t lane = 0; lane < kGroup; lane += kWidth) {
    SphereSums sphere = load_sphere(sums, lane);
    for (std::uint32_t c = first_chunk; c != BrickPoints::kNoChunk; c = points.next_chunk(c)) {
      const PointChunk& chunk = points.chunk(c);
      const std::uint32_t near = sift(chunk, frame, tool);
      for (std::size_t slot = lane; slot < PointChunk::kSlots; slot += kGroup) {
        if ((near >> slot & kWidthBits) == 0) continue;
        const Points p = points_at(chunk, slot, frame);
        const V inverse = inverse_root(hn::Max(p.from_centre2, constant(kOnAxis_mm2)));
        touching += touch_sphere(p, hn::Gt(p.area, hn::Zero(d)), inverse, frame, tool, sphere);
      }
    }
    store(sphere, sums, lane);
  }
  sums.touching += static_cast<int>(touching);
}

}  // namespace HWY_NAMESPACE
}  // namespace osteomill::point_shell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteomill::point_shell {

HWY_EXPORT(AddPoints);
HWY_EXPORT(AddSidePoints);
HWY_EXPORT(AddSpherePoints);

std::uint32_t add_points(const PointChunk& chunk, const KernelFrame& frame, const KernelTool& tool,
                         KernelSums& sums) {
  return HWY_DYNAMIC_DISPATCH(AddPoints)(chunk, frame, tool, sums);
}

void add_side_points(const BrickPoints& points, std::uint32_t first_chunk, const KernelFrame& frame,
                     const KernelTool& tool, KernelSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddSidePoints)(points, first_chunk, frame, tool, sums);
}

void add_sphere_points(const BrickPoints& points, std::uint32_t first_chunk, const KernelFrame& frame,
                       const KernelTool& tool, KernelSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddSpherePoints)(points, first_chunk, frame, tool, sums);
}

std::int64_t kernel_targets() {
  return HWY_TARGETS;
}

}  // namespace osteomill::point_shell
#endif
