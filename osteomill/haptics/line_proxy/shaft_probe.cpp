#include "osteomill/haptics/line_proxy/shaft_probe.h"

#include <algorithm>
#include <array>
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

// The samples along the shaft: the vertices and places between them, numbered from 0.
class ShaftSamples {
 public:
  ShaftSamples(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT)
      : volume_(volume), vertices_T_(vertices_T), X_WT_(X_WT) {}

  int count() const { return static_cast<int>(vertices_T_.size() - 1) * kSubsteps + 1; }
  Vec3 point_W(double sample) const {
    const double place = sample / kSubsteps;
    const auto below = std::min(static_cast<std::size_t>(place), vertices_T_.size() - 1);
    const Vec3& from = vertices_T_[below];
    const Vec3& to = vertices_T_[std::min(below + 1, vertices_T_.size() - 1)];
    return X_WT_ * Vec3(from + (place - static_cast<double>(below)) * (to - from));
  }
  bool is_in_bone(int sample) const {
    return density_at(volume_.grid(), point_W(sample)) > volume_.isovalue();
  }
  double nearest(const Vec3& point_W) const {
    const double along_mm = shaft_direction(X_WT_).dot(point_W - X_WT_.position_mm) - vertices_T_.front().z();
    const double spacing_mm = vertices_T_.size() < 2 ? 1.0 : (vertices_T_[1] - vertices_T_[0]).norm();
    return kSubsteps * along_mm / spacing_mm;
  }

 private:
  const Volume& volume_;
  std::span<const Vec3> vertices_T_;
  const Pose& X_WT_;
};

struct Run {
  int first;
  int last;
  double distance_to(double sample) const { return std::max({0.0, first - sample, sample - last}); }
};

std::optional<Run> nearest_run(const ShaftSamples& samples, double to_sample) {
  std::optional<Run> nearest;
  std::optional<Run> current;
  for (int n = 0; n <= samples.count(); ++n) {
    if (n < samples.count() && samples.is_in_bone(n)) {
      current = Run{current ? current->first : n, n};
    } else if (current) {
      if (!nearest || current->distance_to(to_sample) < nearest->distance_to(to_sample)) nearest = current;
      current.reset();
    }
  }
  return nearest;
}

constexpr double kDeepest_mm = 5.0;

// How far from a point in bone along `out_W` the bone ends; nothing beyond kDeepest_mm.
std::optional<double> depth_along(const Volume& volume, const Vec3& point_W, const Vec3& out_W) {
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  double above_iso = density_at(volume.grid(), point_W) - volume.isovalue();
  if (!(above_iso > 0.0)) return 0.0;
  for (double depth_mm = step_mm; depth_mm <= kDeepest_mm; depth_mm += step_mm) {
    const double here = density_at(volume.grid(), point_W + depth_mm * out_W) - volume.isovalue();
    if (!(here > 0.0)) return depth_mm - step_mm * here / (here - above_iso);
    above_iso = here;
  }
  return std::nullopt;
}

// The mean sample of a run, weighted by a high power of the depth: the deepest one where it stands out.
std::optional<double> deepest_sample(const Volume& volume, const ShaftSamples& samples, const Run& run,
                                     const Vec3& out_W) {
  constexpr int kMostSamples = 32;
  std::array<double, kMostSamples> depths_mm;
  const int stride = (run.last - run.first) / kMostSamples + 1;
  std::size_t count = 0;
  double deepest_mm = 0.0;
  for (int n = run.first; n <= run.last; n += stride, ++count) {
    const auto depth_mm = depth_along(volume, samples.point_W(n), out_W);
    if (!depth_mm) return std::nullopt;
    depths_mm[count] = *depth_mm;
    deepest_mm = std::max(deepest_mm, *depth_mm);
  }
  if (!(deepest_mm > 0.0)) return run.first;
  double weights = 0.0;
  double moment = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    double weight = depths_mm[n] / deepest_mm;
    for (int square = 0; square < 4; ++square) weight *= weight;  // the 16th power
    weights += weight;
    moment += weight * (run.first + static_cast<int>(n) * stride);
  }
  return moment / weights;
}

}  // namespace

std::optional<ShaftDepth> deepest_across(const Volume& volume, std::span<const Vec3> vertices_T,
                                         const Pose& X_WT, const Vec3& intersection_before_W,
                                         const Vec3& out_W) {
  const ShaftSamples samples(volume, vertices_T, X_WT);
  const auto run = nearest_run(samples, samples.nearest(intersection_before_W));
  if (!run) return std::nullopt;
  const auto deepest = deepest_sample(volume, samples, *run, out_W);
  if (!deepest) return std::nullopt;
  const Vec3 point_W = samples.point_W(*deepest);
  const auto depth_mm = depth_along(volume, point_W, out_W);
  if (!depth_mm) return std::nullopt;
  return ShaftDepth{point_W, point_W + *depth_mm * out_W};
}

int vertices_in_bone(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT) {
  int count = 0;
  for (const Vec3& vertex_T : vertices_T) {
    if (density_at(volume.grid(), X_WT * vertex_T) > volume.isovalue()) ++count;
  }
  return count;
}

}  // namespace osteomill::line_proxy
