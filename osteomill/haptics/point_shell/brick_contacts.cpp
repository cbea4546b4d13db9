#include "osteomill/haptics/point_shell/brick_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "osteomill/haptics/point_shell/contact_tool.h"
#include "osteomill/haptics/point_shell/tool_from_grid.h"

namespace osteomill {

namespace {

constexpr std::size_t kSlots = PointChunk::kSlots;

// A brick's frame seen from the tool, in single precision: near the tool its numbers are small.
struct FloatFrame {
  float turn[3][3];
  float offset_mm[3];

  FloatFrame(const Mat3& turn_TG, const Vec3& offset_T) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) turn[row][column] = static_cast<float>(turn_TG(row, column));
      offset_mm[row] = static_cast<float>(offset_T[row]);
    }
  }
};

// What may touch in single precision: squared radii and ends, each wider by more than the rounding.
struct Reach {
  float burr_squared_mm2;
  float shaft_squared_mm2;
  float shaft_from_mm;
  float shaft_to_mm;

  Reach(const MillingTool& tool, double beyond_mm) {
    constexpr double kRounding_mm = 1e-4;
    const double wider_mm = beyond_mm + kRounding_mm;
    const auto squared = [&](double radius) {
      return static_cast<float>((radius + wider_mm) * (radius + wider_mm));
    };
    burr_squared_mm2 = squared(tool.burr_radius_mm);
    shaft_squared_mm2 = squared(tool.shaft_radius_mm);
    shaft_from_mm = static_cast<float>(-wider_mm);
    shaft_to_mm = static_cast<float>(tool.shaft_length_mm + wider_mm);
  }
};

using Flags = std::array<int, kSlots>;

// Flags the points that may touch; whether there are any. Written so that the compiler makes vector
// instructions of it.
bool find_candidates(const PointChunk& chunk, const FloatFrame& frame, const Reach& reach, Flags& candidate) {
  const float *cx = chunk.x_mm.data(), *cy = chunk.y_mm.data(), *cz = chunk.z_mm.data();
  const auto& m = frame.turn;
  int any = 0;
  for (std::size_t n = 0; n < kSlots; ++n) {
    const float x = frame.offset_mm[0] + m[0][0] * cx[n] + m[0][1] * cy[n] + m[0][2] * cz[n];
    const float y = frame.offset_mm[1] + m[1][0] * cx[n] + m[1][1] * cy[n] + m[1][2] * cz[n];
    const float z = frame.offset_mm[2] + m[2][0] * cx[n] + m[2][1] * cy[n] + m[2][2] * cz[n];
    const float radial_squared = x * x + y * y;
    const int in_burr = radial_squared + z * z < reach.burr_squared_mm2;
    const int in_side = radial_squared < reach.shaft_squared_mm2;
    const int in_ends = static_cast<int>(z > reach.shaft_from_mm) & static_cast<int>(z < reach.shaft_to_mm);
    candidate[n] = in_burr | (in_side & in_ends);
    any |= candidate[n];
  }
  return any != 0;
}

// A point of the shell as seen from the tool.
struct Patch {
  Vec3 position_T;
  Vec3 normal_T;
  double area_mm2;
};

// The sums of `ToolContacts` for the tool in closed form, without the terms that are zero by its shape: on
// the burr r x n = 0; on the shaft's side n = (x, y, 0) / radial and r x n = z (-n_y, n_x, 0).
class ShapedSums {
 public:
  ShapedSums(const MillingTool& tool, const Penalty& penalty)
      : tool_(tool),
        penalty_(penalty),
        burr_top_mm_(ContactTool::burr_top_mm(tool)),
        burr_curvature_per_mm_(2 / tool.burr_radius_mm),
        shaft_curvature_per_mm_(1 / tool.shaft_radius_mm) {}

  void touch(const Patch& patch) {
    const Vec3& p = patch.position_T;
    const double radial_squared = p.x() * p.x() + p.y() * p.y();
    const double from_centre = std::sqrt(radial_squared + p.z() * p.z());
    const double radial = std::sqrt(radial_squared);
    const double beyond_burr = from_centre - tool_.burr_radius_mm;
    const double beyond_side = radial - tool_.shaft_radius_mm;
    const double beyond_end = p.z() > 0.5 * tool_.shaft_length_mm ? p.z() - tool_.shaft_length_mm : -p.z();
    if (beyond_burr < std::max(beyond_side, beyond_end)) {
      touch_sphere(patch, beyond_burr, from_centre);
    } else if (beyond_side > beyond_end && beyond_end <= 0 && radial > 0) {
      touch_side(patch, beyond_side, radial);
    } else {
      touch_end(patch);
    }
  }

  ToolContacts contacts() const {
    ToolContacts all{burr_, shaft_, touching_};
    all.burr += sum_of(burr_side_);
    all.shaft += sum_of(shaft_side_);
    return all;
  }

 private:
  // Sums over points on the shaft's side of k, times powers of z and components of n.
  struct SideSums {
    double push_x = 0, push_y = 0, push_zx = 0, push_zy = 0;
    double xx[3] = {0, 0, 0}, xy[3] = {0, 0, 0}, yy[3] = {0, 0, 0};
  };

  bool is_burr(const Patch& patch) const { return patch.position_T.z() < burr_top_mm_; }

  // Counts it where there is one.
  Penalty::Push push(const Patch& patch, double distance_mm, const Vec3& n) {
    const double curvature = is_burr(patch) ? burr_curvature_per_mm_ : shaft_curvature_per_mm_;
    const Penalty::Push push = penalty_.push(-distance_mm, patch.area_mm2, n.dot(patch.normal_T), curvature);
    if (push.force_N > 0) ++touching_;
    return push;
  }

  void touch_sphere(const Patch& patch, double distance_mm, double from_centre) {
    const Vec3 n = from_centre > 0 ? Vec3(patch.position_T / from_centre) : Vec3(0, 0, -1);
    const Penalty::Push p = push(patch, distance_mm, n);
    if (p.force_N > 0) (is_burr(patch) ? burr_ : shaft_).add_central(p.force_N, p.stiffness_N_per_mm, n);
  }

  void touch_side(const Patch& patch, double distance_mm, double radial) {
    const double nx = patch.position_T.x() / radial, ny = patch.position_T.y() / radial;
    const double z = patch.position_T.z();
    const Penalty::Push p = push(patch, distance_mm, {nx, ny, 0});
    if (!(p.force_N > 0)) return;
    SideSums& sums = is_burr(patch) ? burr_side_ : shaft_side_;
    sums.push_x += p.force_N * nx;
    sums.push_y += p.force_N * ny;
    sums.push_zx += p.force_N * z * nx;
    sums.push_zy += p.force_N * z * ny;
    const double k = p.stiffness_N_per_mm;
    const double kxx = k * nx * nx, kxy = k * nx * ny, kyy = k * ny * ny;
    double power = 1;
    for (int n = 0; n < 3; ++n, power *= z) {
      sums.xx[n] += power * kxx;
      sums.xy[n] += power * kxy;
      sums.yy[n] += power * kyy;
    }
  }

  // The shaft's ends and their rims, and its axis: few points, so the general way.
  void touch_end(const Patch& patch) {
    const ToolDistance distance = tool_distance(tool_, patch.position_T);
    const Penalty::Push p = push(patch, distance.distance_mm, distance.outward_T);
    if (!(p.force_N > 0)) return;
    (is_burr(patch) ? burr_ : shaft_)
        .add(p.force_N, p.stiffness_N_per_mm, distance.outward_T, patch.position_T);
  }

  static ContactSum sum_of(const SideSums& s) {
    ContactSum sum;
    sum.force_N = {-s.push_x, -s.push_y, 0};
    sum.torque_Nmm = {s.push_zy, -s.push_zx, 0};
    sum.K_ff << s.xx[0], s.xy[0], 0, s.xy[0], s.yy[0], 0, 0, 0, 0;
    sum.K_ft << -s.xy[1], s.xx[1], 0, -s.yy[1], s.xy[1], 0, 0, 0, 0;
    sum.K_tt << s.yy[2], -s.xy[2], 0, -s.xy[2], s.xx[2], 0, 0, 0, 0;
    return sum;
  }

  const MillingTool& tool_;
  const Penalty& penalty_;
  double burr_top_mm_;
  double burr_curvature_per_mm_;
  double shaft_curvature_per_mm_;
  ContactSum burr_;
  ContactSum shaft_;
  SideSums burr_side_;
  SideSums shaft_side_;
  int touching_ = 0;
};

// Whether a sphere lies clear of the tool. Beside a corner of the shaft's end it may say no where it is
// clear.
bool is_clear(const MillingTool& tool, const Vec3& centre_T, double radius_mm) {
  const double radial_squared = centre_T.x() * centre_T.x() + centre_T.y() * centre_T.y();
  const double z = centre_T.z();
  const double burr_reach = tool.burr_radius_mm + radius_mm;
  if (radial_squared + z * z <= burr_reach * burr_reach) return false;
  const double shaft_reach = tool.shaft_radius_mm + radius_mm;
  return radial_squared > shaft_reach * shaft_reach || z < -radius_mm || z > tool.shaft_length_mm + radius_mm;
}

Vec3 centre_of(const BrickPoints::Bound& bound) {
  return {static_cast<double>(bound.centre_mm[0]), static_cast<double>(bound.centre_mm[1]),
          static_cast<double>(bound.centre_mm[2])};
}

}  // namespace

ToolContacts contacts_by_bricks(const PointShell& shell, const MillingTool& tool, const Pose& X_WT,
                                const Penalty& penalty) {
  const ToolFromGrid X_TG(shell, X_WT);
  const BrickPoints& points = shell.points();
  const double beyond_mm = penalty.reach_mm();
  const Reach reach(tool, beyond_mm);
  ShapedSums sums(tool, penalty);
  Flags candidate;
  const auto is_node_clear = [&](int level, int i, int j, int k) {
    if (level == 0) {
      const BrickPoints::Bound& bound = points.brick(shell.brick_index(i, j, k)).bound;
      return is_clear(tool, X_TG * (shell.brick_origin_G(i, j, k) + centre_of(bound)),
                      static_cast<double>(bound.radius_mm) + beyond_mm);
    }
    const PointShell::NodeBox box = shell.node_box(level, i, j, k);
    return is_clear(tool, X_TG * box.middle_G, box.half_mm.norm() + beyond_mm);
  };
  shell.octree().visit(is_node_clear, [&](int bi, int bj, int bk) {
    const Vec3 origin_T = X_TG * shell.brick_origin_G(bi, bj, bk);
    const FloatFrame frame(X_TG.turn, origin_T);
    const std::uint32_t first = points.brick(shell.brick_index(bi, bj, bk)).first_chunk;
    for (std::uint32_t c = first; c != BrickPoints::kNoChunk; c = points.next_chunk(c)) {
      const PointChunk& chunk = points.chunk(c);
      if (!find_candidates(chunk, frame, reach, candidate)) continue;
      for (std::size_t n = 0; n < kSlots; ++n) {
        if (candidate[n] == 0) continue;
        const ShellPoint point = chunk.point(n);
        sums.touch({origin_T + X_TG.turn * position_of(point), X_TG.turn * normal_of(point),
                    static_cast<double>(point.area_mm2)});
      }
    }
  });
  const ToolContacts contacts = sums.contacts();
  const Mat3 R_WT = X_WT.orientation.toRotationMatrix();
  return {contacts.burr.in_outer(R_WT), contacts.shaft.in_outer(R_WT), contacts.touching};
}

}  // namespace osteomill
