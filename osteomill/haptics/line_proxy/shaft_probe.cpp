#include "osteomill/haptics/line_proxy/shaft_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

constexpr int kSubsteps = 4;

// A quarter of the vertices' spacing along b; nothing where b has no direction.
Vec3 substep_along(const Vec3& b, std::span<const Vec3> vertices_T) {
  const double length = b.norm();
  if (vertices_T.size() < 2 || !(length > 0.0) || !std::isfinite(length)) return Vec3::Zero();
  return (vertices_T[1] - vertices_T[0]).norm() / kSubsteps / length * b;
}

}  // namespace

ShaftProbe densest_point(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                         const Vec3& intersection_before_W) {
  const Vec3 substep = substep_along(X_WT.position_mm - intersection_before_W, vertices_T);
  double densest = -std::numeric_limits<double>::infinity();
  Vec3 first = X_WT * vertices_T.front();
  Vec3 last = first;
  bool in_run = false;
  for (const Vec3& vertex_T : vertices_T) {
    const Vec3 vertex_W = X_WT * vertex_T;
    // b points down the shaft, so that the farthest sub-step comes first on the way up.
    for (int n = kSubsteps - 1; n >= 0; --n) {
      const Vec3 point_W = vertex_W + n * substep;
      const double density = density_at(volume.grid(), point_W);
      if (density > densest) {
        densest = density;
        first = last = point_W;
        in_run = true;
      } else if (density == densest && in_run) {
        last = point_W;
      } else {
        in_run = false;
      }
    }
  }
  return {0.5 * (first + last), densest};
}

namespace {

int sample_count(std::span<const Vec3> vertices_T) {
  return static_cast<int>(vertices_T.size() - 1) * kSubsteps + 1;
}

double above_isovalue(const Volume& volume, const Vec3& point_W) {
  return density_at(volume.grid(), point_W) - volume.isovalue();
}

double distance_to(const ShaftRun& run, double sample) {
  return std::max({0.0, run.first - sample, sample - run.last});
}

}  // namespace

Vec3 sample_W(std::span<const Vec3> vertices_T, const Pose& X_WT, double sample) {
  const double place = sample / kSubsteps;
  const auto below = std::min(static_cast<std::size_t>(place), vertices_T.size() - 1);
  const Vec3& from = vertices_T[below];
  const Vec3& to = vertices_T[std::min(below + 1, vertices_T.size() - 1)];
  return X_WT * Vec3(from + (place - static_cast<double>(below)) * (to - from));
}

std::optional<ShaftRun> nearest_run(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                                    const Vec3& near_W) {
  const double spacing_mm = vertices_T.size() < 2 ? 1.0 : (vertices_T[1] - vertices_T[0]).norm();
  const double near_sample =
      kSubsteps * shaft_direction(X_WT).dot(near_W - X_WT * vertices_T.front()) / spacing_mm;
  std::optional<ShaftRun> nearest;
  std::optional<ShaftRun> current;
  const int count = sample_count(vertices_T);
  for (int n = 0; n <= count; ++n) {
    if (n < count && above_isovalue(volume, sample_W(vertices_T, X_WT, n)) > 0.0) {
      current = ShaftRun{current ? current->first : n, n};
    } else if (current) {
      if (!nearest || distance_to(*current, near_sample) < distance_to(*nearest, near_sample))
        nearest = current;
      current.reset();
    }
  }
  return nearest;
}

double middle_of(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                 const ShaftRun& run) {
  double weights = 0.0;
  double moment = 0.0;
  for (int n = run.first; n <= run.last; ++n) {
    const double weight = above_isovalue(volume, sample_W(vertices_T, X_WT, n));
    weights += weight;
    moment += weight * n;
  }
  return weights > 0.0 ? moment / weights : run.first;
}

namespace {

// How far from a point in bone along `out_W` the bone ends; nothing beyond the limit.
std::optional<double> depth_along(const Volume& volume, const Vec3& point_W, const Vec3& out_W,
                                  double limit_mm) {
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  double above_iso = above_isovalue(volume, point_W);
  if (!(above_iso > 0.0)) return 0.0;
  for (double depth_mm = step_mm; depth_mm < limit_mm + step_mm; depth_mm += step_mm) {
    const double here = above_isovalue(volume, point_W + depth_mm * out_W);
    if (!(here > 0.0)) return depth_mm - step_mm * here / (here - above_iso);
    above_iso = here;
  }
  return std::nullopt;
}

// A mean of sample numbers, weighted by the 16th power of the depth: the deepest one where it stands out.
class DeepestMean {
 public:
  explicit DeepestMean(double scale_mm) : scale_mm_(scale_mm) {}
  void add(double sample, double depth_mm) {
    double weight = depth_mm / scale_mm_;
    for (int square = 0; square < 4; ++square) weight *= weight;
    weights_ += weight;
    moment_ += weight * sample;
  }
  double mean() const { return moment_ / weights_; }

 private:
  double scale_mm_;
  double weights_ = 0.0;
  double moment_ = 0.0;
};

}  // namespace

std::optional<Vec3> deepest_across(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                                   const ShaftRun& run, double middle, const Vec3& out_W, double limit_mm) {
  constexpr int kMostSamplesEachWay = 16;
  const auto depth_at = [&](double sample) {
    return depth_along(volume, sample_W(vertices_T, X_WT, sample), out_W, limit_mm);
  };
  const int start = std::clamp(static_cast<int>(std::lround(middle)), run.first, run.last);
  const auto start_mm = depth_at(start);
  if (!start_mm || !(*start_mm > 0.0)) return std::nullopt;
  const int stride = (run.last - run.first) / (2 * kMostSamplesEachWay) + 1;
  const double spacing_mm =
      (sample_W(vertices_T, X_WT, start + 1) - sample_W(vertices_T, X_WT, start)).norm();
  // A surface steeper than 2 to 1 against the shaft counts as a leap.
  const double leap_mm = 2.0 * stride * spacing_mm;
  DeepestMean deepest(*start_mm);
  deepest.add(start, *start_mm);
  for (const int way : {-stride, stride}) {
    double before_mm = *start_mm;
    for (int n = start + way; n >= run.first && n <= run.last; n += way) {
      const auto depth_mm = depth_at(n);
      if (!depth_mm || std::abs(*depth_mm - before_mm) > leap_mm) break;
      deepest.add(n, *depth_mm);
      before_mm = *depth_mm;
    }
  }
  const double place = deepest.mean();
  const auto depth_mm = depth_at(place);
  if (!depth_mm) return std::nullopt;
  return sample_W(vertices_T, X_WT, place) + *depth_mm * out_W;
}

int vertices_in_bone(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT) {
  int count = 0;
  for (const Vec3& vertex_T : vertices_T) {
    if (density_at(volume.grid(), X_WT * vertex_T) > volume.isovalue()) ++count;
  }
  return count;
}

}  // namespace osteomill::line_proxy
