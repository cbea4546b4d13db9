#include <algorithm>

#include "verification/bone_surface.h"
#include "verification/in_parallel.h"
#include "verification/probing.h"
#include "verification/sections.h"
#include <fmt/core.h>

#include "osteomill/operator/hand.h"
#include "osteomill/operator/simulated_handle.h"

namespace osteomill::verification {

namespace {

constexpr double kDeepest_mm = 0.3;
// The shaft lies with its middle in the surface: whatever is deeper is through.
constexpr double kThrough_mm = 0.99;
constexpr int kTicksBetweenLooks = 4;
constexpr std::size_t kBatch = 250;

// A way for the tool to come at the bone: from free space, along a line, at a speed.
struct Push {
  Pose X_W_start;
  Vec3 direction_W;
  double force_N;
  double speed_mm_s;
};

// Towards a random point of the surface, from any side, the shaft any way; begun a little before it touches.
Push random_push(const BoneSurface& surface, const MillingTool& tool, SeededRandom& random) {
  Push push;
  const auto count = static_cast<double>(surface.points().size());
  const Vec3 aim = surface.points()[static_cast<std::size_t>(random.uniform(0, count))];
  push.direction_W = random_direction(random);
  push.X_W_start.orientation = random_orientation(random);
  push.force_N = random.uniform(2, 10);
  push.speed_mm_s = random.uniform(20, 300);
  // The tool grown by 0.3 mm, from far outside up to where it first meets bone.
  const MillingTool grown{tool.burr_radius_mm + 0.3, tool.shaft_radius_mm + 0.3, tool.shaft_length_mm + 0.3};
  for (double back_mm = 45; back_mm > 0; back_mm -= 0.5) {
    const Vec3 next = aim - back_mm * push.direction_W;
    if (surface.deepest_mm(grown, {next, push.X_W_start.orientation}) > 0) break;
    push.X_W_start.position_mm = next;
  }
  return push;
}

// How far past the surface something came, at any time and at the end.
struct Depth {
  double ever_mm = -1;
  double at_end_mm = -1;

  void look(double deep_mm) {
    at_end_mm = deep_mm;
    ever_mm = std::max(ever_mm, deep_mm);
  }
};

// What is felt (of 1 the centreline that it collides, of the others the tool), and what is drawn.
struct Outcome {
  Depth felt;
  Depth drawn_centreline;
  Depth drawn_tool;
};

void look(Outcome& outcome, std::string_view id, const BoneSurface& surface, const MillingTool& tool,
          const HapticStep& step) {
  outcome.drawn_centreline.look(surface.centreline_deep_mm(tool, step.X_WT));
  outcome.drawn_tool.look(surface.deepest_mm(tool, step.X_WT));
  const Pose X_WF = step.X_WF.value_or(step.X_WT);
  outcome.felt.look(id == "line-proxy" ? surface.centreline_deep_mm(tool, X_WF)
                                       : surface.deepest_mm(tool, X_WF));
}

Outcome carry_out(const Push& push, std::string_view id, HapticAlgorithm& algorithm,
                  const BoneSurface& surface, const MillingTool& tool) {
  algorithm.reset();
  HandSettings hand;
  hand.push_N = push.force_N;
  SimulatedHandle handle(HandleSettings{}, push.X_W_start);
  const double travel_mm = 1 + 1.2 * push.force_N / hand.stiffness_N_per_mm;
  const int moving = static_cast<int>(travel_mm / (push.speed_mm_s * kTick_s));
  const int substeps = static_cast<int>(kTick_s / handle.settings().substep_s + 0.5);
  Outcome outcome;
  Pose target = push.X_W_start;
  for (int n = 0; n < moving + 150; ++n) {
    const HapticStep step = algorithm.step(handle.read(), kTick_s);
    handle.command(make_safe(step.wrench, WrenchLimits{}).wrench);
    if (n % kTicksBetweenLooks == 0) look(outcome, id, surface, tool, step);
    const Twist velocity{n < moving ? Vec3(push.speed_mm_s * push.direction_W) : Vec3::Zero(), Vec3::Zero()};
    target.position_mm += kTick_s * velocity.linear_mm_s;
    for (int substep = 0; substep < substeps; ++substep) {
      handle.advance(hand_wrench(hand, target, velocity, handle.pose(), handle.velocity()));
    }
  }
  return outcome;
}

std::vector<Outcome> outcomes(std::string_view id, const Volume& bone, const BoneSurface& surface,
                              int pushes) {
  const MillingTool tool;
  std::vector<Outcome> all(static_cast<std::size_t>(pushes));
  in_parallel((all.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const auto algorithm = make_algorithm(id, HapticSettings{});
    algorithm->prepare({&bone, tool});
    SeededRandom random(100 + batch);
    for (std::size_t n = batch * kBatch; n < std::min(all.size(), (batch + 1) * kBatch); ++n) {
      all[n] = carry_out(random_push(surface, tool, random), id, *algorithm, surface, tool);
    }
  });
  return all;
}

// How many of 10,000 pushes may end deeper, by what is felt.
double allowed_in_10000(std::string_view id) {
  if (id == "line-proxy") return 5;
  return id == "surface-points" ? 1 : 0;
}

using Depths = Depth Outcome::*;

std::size_t count_deeper(const std::vector<Outcome>& all, Depths depths, double Depth::*when,
                         double limit_mm) {
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](const Outcome& one) { return one.*depths.*when > limit_mm; }));
}

// "end deeper / ever deeper / through at the end".
std::string counts(const std::vector<Outcome>& all, Depths depths) {
  return fmt::format("{} / {} / {}", count_deeper(all, depths, &Depth::at_end_mm, kDeepest_mm),
                     count_deeper(all, depths, &Depth::ever_mm, kDeepest_mm),
                     count_deeper(all, depths, &Depth::at_end_mm, kThrough_mm));
}

}  // namespace

Section random_pushes(const Bones& bones, const Effort& effort) {
  Section section{
      "Pushes from anywhere",
      fmt::format(
          "Must hold: what is felt ends more than {} mm past the surface in at most 5 of 10,000 pushes "
          "for 1, 1 for 2, none for 3, and that of 4 is never there. {} pushes of 2 to 10 N at 20 to "
          "300 mm/s against {}, burr or shaft first, from any side and in any pose, looked at every "
          "{} ms independently of the algorithms. What is felt is the tool at the pose that the "
          "wrench holds it at (1: its centreline, which is what 1 collides); what is drawn is shown "
          "as its centreline and as the tool with its radii. Each as pushes that end deeper / ever "
          "are deeper / end through (deeper than {} mm, the shaft's radius).",
          kDeepest_mm, effort.pushes, bones.tooth_name, kTicksBetweenLooks, kThrough_mm),
      {"algorithm", "felt", "drawn centreline", "drawn tool", "felt at the end: median, mm", "99.9 %, mm",
       "deepest, mm", ""},
      {},
      {}};
  const BoneSurface surface(bones.tooth);
  for (const std::string& id : algorithm_names()) {
    const std::vector<Outcome> all = outcomes(id, bones.tooth, surface, effort.pushes);
    std::vector<double> at_end;
    for (const Outcome& outcome : all) at_end.push_back(outcome.felt.at_end_mm);
    const auto deeper =
        static_cast<double>(count_deeper(all, &Outcome::felt, &Depth::at_end_mm, kDeepest_mm));
    const std::size_t ever = count_deeper(all, &Outcome::felt, &Depth::ever_mm, kDeepest_mm);
    section.add({id, counts(all, &Outcome::felt), counts(all, &Outcome::drawn_centreline),
                 counts(all, &Outcome::drawn_tool), figure(distribution_of(at_end).median),
                 figure(percentile(at_end, 0.999)), figure(percentile(at_end, 1))},
                deeper <= allowed_in_10000(id) * std::max(1.0, effort.pushes / 1e4) &&
                    (id != "barrier-shell" || ever == 0));
  }
  return section;
}

}  // namespace osteomill::verification
