#include "bone_points/brick_kernel.h"

// AVX3_DL and SSSE3 bring no gain over their neighbours.
#define HWY_DISABLED_TARGETS \
  (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
// This file is compiled once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bone_points/brick_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "osteomill/base/compress_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteomill {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Never uses hn::MulAdd, which rounds once with FMA and twice without.
using D = hn::CappedTag<float, CrossingRow::kNodes>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t kWidth = hn::MaxLanes(d);

// Smallest share of a cell's face that a crossing represents, and the share of a crossing without a normal.
constexpr float kMinCosine = 0.02f;
constexpr float kCosineWithoutNormal = 0.6f;
// If the normals' sum is shorter than this share of the area, they cancel, and the point has no normal.
constexpr float kNoNormal = 1e-6f;

HWY_INLINE V constant(float value) {
  return hn::Set(d, value);
}

HWY_INLINE hn::Mask<D> lanes_of(unsigned bits) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return hn::LoadMaskBits(d, bytes);
}

// Named members, because GCC 12 keeps an array of vectors in memory.
struct V3 {
  V x, y, z;
};
HWY_INLINE V3 scaled(V3 v, V by) {
  return {hn::Mul(by, v.x), hn::Mul(by, v.y), hn::Mul(by, v.z)};
}
HWY_INLINE V3 sum(V3 a, V3 b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V length(V3 v) {
  return hn::Sqrt(hn::Add(hn::Add(hn::Mul(v.x, v.x), hn::Mul(v.y, v.y)), hn::Mul(v.z, v.z)));
}
template <int kAxis>
HWY_INLINE V& along(V3& v) {
  return kAxis == 0 ? v.x : kAxis == 1 ? v.y : v.z;
}

// Sums over crossings: area times position, area, and area times unit normal.
struct Sums {
  V3 position_mm;
  V area;
  V3 normal;
};

// Returns the central differences at both ends of an edge, interpolated to the crossing.
HWY_INLINE V difference(const float* here, const float* there, std::ptrdiff_t next, float per_step,
                        V fraction) {
  const V from = hn::Sub(hn::LoadU(d, here + next), hn::LoadU(d, here - next));
  const V to = hn::Sub(hn::LoadU(d, there + next), hn::LoadU(d, there - next));
  return hn::Mul(hn::Add(from, hn::Mul(fraction, hn::Sub(to, from))), constant(per_step));
}

// Adds the crossings on edges along an axis that begin at `node` and the nodes after it.
template <int kAxis>
HWY_INLINE void add_crossings(const CrossingLattice& lattice, const CrossingRow& row, std::size_t node,
                              Sums& sums) {
  const unsigned bits = (row.crossed[kAxis] >> node) & ((1u << kWidth) - 1);
  if (bits == 0) return;
  const hn::Mask<D> crossed = lanes_of(bits);
  const auto& [next, isovalue, step, per_step, face] = lattice;
  const float* here = row.densities + node;
  const float* there = here + next[kAxis];
  const V density = hn::LoadU(d, here);
  const V fraction = hn::IfThenElseZero(
      crossed, hn::Div(hn::Sub(constant(isovalue), density), hn::Sub(hn::LoadU(d, there), density)));
  V3 gradient{difference(here, there, next[0], per_step[0], fraction),
              difference(here, there, next[1], per_step[1], fraction),
              difference(here, there, next[2], per_step[2], fraction)};
  const V steepness = length(gradient);
  const auto has_normal = hn::Gt(steepness, hn::Zero(d));
  V3 normal = scaled(gradient, hn::IfThenElseZero(has_normal, hn::Div(constant(-1.0f), steepness)));
  const V cosine = hn::IfThenElse(has_normal, hn::Max(constant(kMinCosine), hn::Abs(along<kAxis>(normal))),
                                  constant(kCosineWithoutNormal));
  const V area = hn::IfThenElseZero(crossed, hn::Mul(constant(face[kAxis]), cosine));
  V3 at{hn::Iota(d, static_cast<float>(row.i + static_cast<int>(node))), constant(static_cast<float>(row.j)),
        constant(static_cast<float>(row.k))};
  along<kAxis>(at) = hn::Add(along<kAxis>(at), fraction);
  const V3 at_mm{hn::Mul(at.x, constant(step[0])), hn::Mul(at.y, constant(step[1])),
                 hn::Mul(at.z, constant(step[2]))};
  sums.position_mm = sum(sums.position_mm, scaled(at_mm, area));
  sums.normal = sum(sums.normal, scaled(normal, area));
  sums.area = hn::Add(sums.area, area);
}

HWY_INLINE void add_means_of(const Sums& sums, unsigned cells, PointRows& points) {
  const V3 position_mm = scaled(sums.position_mm, hn::Div(constant(1.0f), sums.area));
  const V normal_length = length(sums.normal);
  const V3 normal =
      scaled(sums.normal, hn::IfThenElseZero(hn::Gt(normal_length, hn::Mul(constant(kNoNormal), sums.area)),
                                             hn::Div(constant(1.0f), normal_length)));
  const hn::Mask<D> chosen = lanes_of(cells);
  const CompressLanes<D> to_front(d, chosen);
  const std::size_t n = points.count;
  hn::StoreU(to_front(position_mm.x), d, &points.x_mm[n]);
  hn::StoreU(to_front(position_mm.y), d, &points.y_mm[n]);
  hn::StoreU(to_front(position_mm.z), d, &points.z_mm[n]);
  hn::StoreU(to_front(sums.area), d, &points.area_mm2[n]);
  hn::StoreU(to_front(normal.x), d, &points.normal_x[n]);
  hn::StoreU(to_front(normal.y), d, &points.normal_y[n]);
  hn::StoreU(to_front(normal.z), d, &points.normal_z[n]);
  points.count = n + hn::CountTrue(d, chosen);
}

// Sums for every node of a row.
struct StoredSums {
  static constexpr int kSums = 7;
  alignas(64) float rows[kSums][CrossingRow::kMaxNodes] = {};

  HWY_INLINE void store(const Sums& sums, std::size_t node) {
    hn::Store(sums.position_mm.x, d, &rows[0][node]);
    hn::Store(sums.position_mm.y, d, &rows[1][node]);
    hn::Store(sums.position_mm.z, d, &rows[2][node]);
    hn::Store(sums.area, d, &rows[3][node]);
    hn::Store(sums.normal.x, d, &rows[4][node]);
    hn::Store(sums.normal.y, d, &rows[5][node]);
    hn::Store(sums.normal.z, d, &rows[6][node]);
  }
  HWY_INLINE Sums load(std::size_t node) const {
    const auto row = [&](int n) HWY_ATTR { return hn::Load(d, &rows[n][node]); };
    return {{row(0), row(1), row(2)}, row(3), {row(4), row(5), row(6)}};
  }
  // Adds up the consecutive nodes of each cell and stores the results at the beginning of the rows.
  void sum_groups(std::size_t group) {
    for (auto& row : rows) {
      for (std::size_t cell = 0; cell * group < CrossingRow::kMaxNodes; ++cell) {
        float of_cell = 0;
        for (std::size_t n = 0; n < group; ++n) of_cell += row[cell * group + n];
        row[cell] = of_cell;
      }
    }
  }
};

HWY_INLINE Sums sums_of(const CrossingLattice& lattice, std::span<const CrossingRow> rows, std::size_t node) {
  const V zero = hn::Zero(d);
  Sums sums{{zero, zero, zero}, zero, {zero, zero, zero}};
  for (const CrossingRow& row : rows) {
    add_crossings<0>(lattice, row, node, sums);
    add_crossings<1>(lattice, row, node, sums);
    add_crossings<2>(lattice, row, node, sums);
  }
  return sums;
}

void AddMeans(const CrossingLattice& lattice, std::span<const CrossingRow> rows, std::size_t group,
              std::uint32_t cells, PointRows& points) {
  const auto cells_at = [&](std::size_t first) { return (cells >> first) & ((1u << kWidth) - 1); };
  if (group == 1) {
    for (std::size_t node = 0; node < CrossingRow::kNodes; node += kWidth) {
      if (cells_at(node) != 0) add_means_of(sums_of(lattice, rows, node), cells_at(node), points);
    }
    return;
  }
  StoredSums stored;
  for (std::size_t node = 0; node < CrossingRow::kMaxNodes; node += kWidth) {
    stored.store(sums_of(lattice, rows, node), node);
  }
  stored.sum_groups(group);
  for (std::size_t cell = 0; cells >> cell != 0; cell += kWidth) {
    if (cells_at(cell) != 0) add_means_of(stored.load(cell), cells_at(cell), points);
  }
}

// Calls `use(n, lanes)` for each vector of points; `lanes` masks those that exist.
template <typename Use>
HWY_INLINE void for_each_lanes(std::size_t count, const Use& use) {
  for (std::size_t n = 0; n < count; n += kWidth) use(n, hn::FirstN(d, count - n));
}

BrickPoints::Bound BoundOf(const PointRows& points, std::size_t count) {
  BrickPoints::Bound bound;
  if (count == 0) return bound;
  const float* const rows[3] = {points.x_mm.data(), points.y_mm.data(), points.z_mm.data()};
  V centre[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const V first = constant(rows[a][0]);
    V min = first, max = first;
    for_each_lanes(count, [&](std::size_t n, hn::Mask<D> lanes) HWY_ATTR {
      const V at = hn::IfThenElse(lanes, hn::LoadU(d, rows[a] + n), first);
      min = hn::Min(min, at);
      max = hn::Max(max, at);
    });
    bound.centre_mm[a] = 0.5f * (hn::GetLane(hn::MinOfLanes(d, min)) + hn::GetLane(hn::MaxOfLanes(d, max)));
    centre[a] = constant(bound.centre_mm[a]);
  }
  V farthest2 = hn::Zero(d);
  for_each_lanes(count, [&](std::size_t n, hn::Mask<D> lanes) HWY_ATTR {
    V away2 = hn::Zero(d);
    for (std::size_t a = 0; a < 3; ++a) {
      const V away = hn::Sub(hn::LoadU(d, rows[a] + n), centre[a]);
      away2 = hn::Add(away2, hn::Mul(away, away));
    }
    farthest2 = hn::Max(farthest2, hn::IfThenElseZero(lanes, away2));
  });
  constexpr float kSlack = 1.0001f;
  bound.radius_mm = kSlack * hn::GetLane(hn::Sqrt(hn::MaxOfLanes(d, farthest2)));
  return bound;
}

}  // namespace HWY_NAMESPACE
}  // namespace osteomill
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace osteomill {

HWY_EXPORT(AddMeans);
HWY_EXPORT(BoundOf);

void add_means(const CrossingLattice& lattice, std::span<const CrossingRow> rows, int group,
               std::uint32_t cells, PointRows& points) {
  HWY_DYNAMIC_DISPATCH(AddMeans)(lattice, rows, static_cast<std::size_t>(group), cells, points);
}

BrickPoints::Bound bound_of(const PointRows& points, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(BoundOf)(points, count);
}

void choose_point_instructions() {
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::int64_t brick_kernel_targets() {
  return HWY_TARGETS;
}

}  // namespace osteomill
#endif
