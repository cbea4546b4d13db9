#include "osteomill/surface/isosurface_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "osteomill/surface/bone_shares.h"
#include "osteomill/surface/isosurface_ray.h"
#include "osteomill/surface/scale_bar.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

// Colours are linear light, 0 to 1.
using Colour = Eigen::Array3d;

const Colour kBackground(1, 1, 1);
const Colour kDentine(0.80, 0.60, 0.36);
const Colour kEnamel(0.90, 0.87, 0.79);

constexpr int kFinerSamples = 3;
constexpr double kMargin = 1.0 / 12;

struct Camera {
  Vec3 centre_W;
  Vec3 right, up, forward;
  double mm_per_pixel;
  double half_width_pixels, half_height_pixels;

  /// Pixel coordinates from the top left, (0.5, 0.5) the middle of the first pixel.
  Vec3 ray_origin_W(double x, double y) const {
    return centre_W + mm_per_pixel * ((x - half_width_pixels) * right + (half_height_pixels - y) * up);
  }
};

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

Camera camera_of(const PictureView& view) {
  require(view.width_pixels > 0 && view.height_pixels > 0, "isosurface_picture: no pixels");
  require(view.width_mm > 0 && std::isfinite(view.width_mm), "isosurface_picture: the width must be above 0");
  require(view.centre_W.allFinite() && view.direction_W.allFinite() && view.up_W.allFinite(),
          "isosurface_picture: the view is not finite");
  const Vec3 forward = view.direction_W.normalized();
  const Vec3 right = forward.cross(view.up_W.normalized());
  require(view.direction_W.norm() > 0 && view.up_W.norm() > 0 && right.norm() > 1e-6,
          "isosurface_picture: direction and up must differ");
  return {view.centre_W,
          right.normalized(),
          right.normalized().cross(forward),
          forward,
          view.width_mm / view.width_pixels,
          0.5 * view.width_pixels,
          0.5 * view.height_pixels};
}

double greatest_density(const BrickRanges& bricks) {
  float greatest = bricks.at(0, 0, 0).greatest;
  for (int bk = 0; bk < bricks.dims()[2]; ++bk)
    for (int bj = 0; bj < bricks.dims()[1]; ++bj)
      for (int bi = 0; bi < bricks.dims()[0]; ++bi)
        greatest = std::max(greatest, bricks.at(bi, bj, bk).greatest);
  return static_cast<double>(greatest);
}

// One look along a ray.
struct Look {
  Colour colour = kBackground;
  double away_mm = 0;
  bool hit = false;
};

class Painter {
 public:
  Painter(const Volume& volume, const Camera& camera)
      : volume_(volume),
        camera_(camera),
        rays_(volume),
        shares_(volume),
        spacing_mm_(volume.geometry().spacing_mm.minCoeff()),
        greatest_density_(greatest_density(volume.bricks())),
        key_light_((-camera.forward + 0.75 * camera.up - 0.6 * camera.right).normalized()) {}

  Look look(double x, double y) const {
    const Vec3 origin_W = camera_.ray_origin_W(x, y);
    const std::optional<RayHit> hit = rays_.first_on_line(origin_W, camera_.forward);
    if (!hit) return {};
    return {shaded(*hit), (hit->point_W - origin_W).dot(camera_.forward), true};
  }

 private:
  // Whiter where it is denser, a little below the surface.
  Colour tint(const RayHit& hit) const {
    double density = volume_.isovalue();
    for (const double voxels : {1.25, 2.5}) {
      const Vec3 below_W = hit.point_W - voxels * spacing_mm_ * hit.normal_W;
      density = std::max(density, density_at(volume_.grid(), below_W));
    }
    const double range = std::max(greatest_density_ - volume_.isovalue(), 1e-9);
    const double t = std::clamp(((density - volume_.isovalue()) / range - 0.42) / 0.35, 0.0, 1.0);
    return kDentine + (t * t * (3 - 2 * t)) * (kEnamel - kDentine);
  }

  // Light from all around that reaches the point: one cone along the normal, four about it.
  double open_sky(const RayHit& hit) const {
    constexpr double kReach_mm = 5.0;
    const Vec3 side = hit.normal_W.unitOrthogonal();
    const Vec3 other = hit.normal_W.cross(side);
    const Vec3 apex_W = hit.point_W + spacing_mm_ * hit.normal_W;
    double sky = shares_.clear_share(apex_W, hit.normal_W, 1.0, kReach_mm);
    for (const Vec3& across : {side, other, Vec3(-side), Vec3(-other)}) {
      const Vec3 direction = (0.7 * hit.normal_W + across).normalized();
      sky += 0.6 * shares_.clear_share(apex_W, direction, 0.8, kReach_mm);
    }
    return sky / 3.4;
  }

  Colour shaded(const RayHit& hit) const {
    const double sky = open_sky(hit);
    const double facing = std::max(0.0, -hit.normal_W.dot(camera_.forward));
    const double key = std::max(0.0, hit.normal_W.dot(key_light_));
    const double lit =
        key > 0 ? shares_.clear_share(hit.point_W + 1.5 * spacing_mm_ * hit.normal_W, key_light_, 0.25, 12.0)
                : 0;
    const Vec3 half_way = (key_light_ - camera_.forward).normalized();
    const double shine = std::pow(std::max(0.0, hit.normal_W.dot(half_way)), 40.0);
    const Colour base = tint(hit);
    return base * (sky * (0.28 + 0.28 * facing) + 0.54 * key * lit) + 0.07 * shine * lit;
  }

  const Volume& volume_;
  const Camera& camera_;
  BoneRays rays_;
  BoneShares shares_;
  double spacing_mm_;
  double greatest_density_;
  Vec3 key_light_;
};

// Calls `draw_row` for all rows, on two threads where there are two cores. Rows do not see each other.
template <typename DrawRow>
void for_all_rows(int rows, const DrawRow& draw_row) {
  const int threads = std::thread::hardware_concurrency() > 1 ? 2 : 1;
  const auto draw_every = [&](int first) {
    for (int y = first; y < rows; y += threads) draw_row(y);
  };
  if (threads == 1) return draw_every(0);
  std::thread other(draw_every, 1);
  draw_every(0);
  other.join();
}

unsigned char byte_of(double light) {
  const double coded = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
  return static_cast<unsigned char>(std::lround(255 * std::clamp(coded, 0.0, 1.0)));
}

struct Looks {
  int width;
  int height;
  std::vector<Look> looks;
  Look& at(int x, int y) {
    return looks[static_cast<std::size_t>(x) + static_cast<std::size_t>(width) * static_cast<std::size_t>(y)];
  }
  const Look& at(int x, int y) const { return const_cast<Looks*>(this)->at(x, y); }
};

// An edge runs here: a pixel beside this one shows something else.
bool differs(const Looks& looks, int x, int y, double mm_per_pixel) {
  const Look& here = looks.at(x, y);
  constexpr std::array<std::array<int, 2>, 4> kBeside{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  for (const auto& [dx, dy] : kBeside) {
    if (x + dx < 0 || y + dy < 0 || x + dx >= looks.width || y + dy >= looks.height) continue;
    const Look& there = looks.at(x + dx, y + dy);
    if (here.hit != there.hit || std::abs(here.away_mm - there.away_mm) > 4 * mm_per_pixel) return true;
    if ((here.colour - there.colour).abs().maxCoeff() > 0.1) return true;
  }
  return false;
}

Colour finer_colour(const Painter& painter, int x, int y) {
  Colour sum(0, 0, 0);
  for (int v = 0; v < kFinerSamples; ++v) {
    for (int u = 0; u < kFinerSamples; ++u) {
      sum += painter.look(x + (u + 0.5) / kFinerSamples, y + (v + 0.5) / kFinerSamples).colour.cwiseMin(1.0);
    }
  }
  return sum / (kFinerSamples * kFinerSamples);
}

}  // namespace

Image isosurface_picture(const Volume& volume, const PictureView& view) {
  const Camera camera = camera_of(view);
  const Painter painter(volume, camera);
  Looks looks{view.width_pixels, view.height_pixels,
              std::vector<Look>(static_cast<std::size_t>(view.width_pixels) *
                                static_cast<std::size_t>(view.height_pixels))};
  for_all_rows(looks.height, [&](int y) {
    for (int x = 0; x < looks.width; ++x) looks.at(x, y) = painter.look(x + 0.5, y + 0.5);
  });
  Image image{looks.width, looks.height, std::vector<unsigned char>(3 * looks.looks.size())};
  for_all_rows(looks.height, [&](int y) {
    for (int x = 0; x < looks.width; ++x) {
      const Colour colour =
          differs(looks, x, y, camera.mm_per_pixel) ? finer_colour(painter, x, y) : looks.at(x, y).colour;
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = byte_of(colour[c]);
    }
  });
  if (view.scale_bar) draw_scale_bar(image, camera.mm_per_pixel);
  return image;
}

PictureView view_of_bone(const Volume& volume, const Vec3& direction_W, const Vec3& up_W, int width_pixels,
                         int height_pixels) {
  PictureView view{Vec3::Zero(), direction_W, up_W, 1, width_pixels, height_pixels, false};
  const Camera camera = camera_of(view);
  const BrickRanges& bricks = volume.bricks();
  Vec3 least = Vec3::Constant(1e300);
  Vec3 greatest = Vec3::Constant(-1e300);
  const auto take_in = [&](const VoxelBox& box) {
    for (int corner = 0; corner < 8; ++corner) {
      const VoxelIndex v{corner & 1 ? box.first.i : box.last.i, corner & 2 ? box.first.j : box.last.j,
                         corner & 4 ? box.first.k : box.last.k};
      const Vec3 point_W = volume.geometry().world_from_voxel(v);
      const Vec3 seen(camera.right.dot(point_W), camera.up.dot(point_W), camera.forward.dot(point_W));
      least = least.cwiseMin(seen);
      greatest = greatest.cwiseMax(seen);
    }
  };
  const VoxelBox all = volume.geometry().all_voxels();
  for (int bk = 0; bk < bricks.dims()[2]; ++bk) {
    for (int bj = 0; bj < bricks.dims()[1]; ++bj) {
      for (int bi = 0; bi < bricks.dims()[0]; ++bi) {
        if (static_cast<double>(bricks.at(bi, bj, bk).greatest) <= volume.isovalue()) continue;
        constexpr int kSide = BrickRanges::kBrickVoxels;
        const VoxelIndex first{bi * kSide, bj * kSide, bk * kSide};
        take_in(VoxelBox{first, {first.i + kSide, first.j + kSide, first.k + kSide}}.intersected(all));
      }
    }
  }
  if (least.x() > greatest.x()) take_in(all);
  const Vec3 middle = 0.5 * (least + greatest);
  view.centre_W = middle.x() * camera.right + middle.y() * camera.up + middle.z() * camera.forward;
  const Vec3 size = greatest - least;
  const double aspect = static_cast<double>(width_pixels) / height_pixels;
  view.width_mm = std::max({size.x(), size.y() * aspect, 1e-6}) * (1 + 2 * kMargin);
  return view;
}

}  // namespace osteomill
