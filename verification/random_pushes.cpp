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

struct Outcome {
  /// How far past the surface the simulated tool came, at any time and at the end.
  double deepest_mm = -1;
  double deepest_at_end_mm = -1;
};

// What an algorithm keeps out of the bone: 1 the tool's centreline, 2 and 3 the tool.
double past_surface_mm(std::string_view id, const BoneSurface& surface, const MillingTool& tool,
                       const Pose& X_WT) {
  return id == "line-proxy" ? surface.centreline_deep_mm(tool, X_WT) : surface.deepest_mm(tool, X_WT);
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
    if (n % kTicksBetweenLooks == 0) {
      outcome.deepest_at_end_mm = past_surface_mm(id, surface, tool, step.X_WT);
      outcome.deepest_mm = std::max(outcome.deepest_mm, outcome.deepest_at_end_mm);
    }
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

}  // namespace

Section random_pushes(const Bones& bones, const Effort& effort) {
  Section section{
      "Pushes from anywhere",
      fmt::format("Must hold: the simulated tool never ends more than {} mm past the surface, that of 4 is "
                  "never there. {} pushes "
                  "of 2 to 10 N at 20 to 300 mm/s against {}, burr or shaft first, from any side and in "
                  "any pose; the overlap of the tool (of 1, which collides the tool's centreline: of "
                  "that) with the isosurface, looked for every {} ms independently of the algorithms.",
                  kDeepest_mm, effort.pushes, bones.tooth_name, kTicksBetweenLooks),
      {"algorithm", "end deeper", "ever deeper", "past at the end: median, mm", "99.9 %, mm", "deepest, mm",
       ""},
      {},
      {}};
  const BoneSurface surface(bones.tooth);
  for (const std::string& id : algorithm_names()) {
    std::vector<double> at_end;
    int ever = 0;
    for (const Outcome& outcome : outcomes(id, bones.tooth, surface, effort.pushes)) {
      at_end.push_back(outcome.deepest_at_end_mm);
      if (outcome.deepest_mm > kDeepest_mm) ++ever;
    }
    const auto deeper = std::count_if(at_end.begin(), at_end.end(), [](double d) { return d > kDeepest_mm; });
    section.add({id, std::to_string(deeper), std::to_string(ever), figure(distribution_of(at_end).median),
                 figure(percentile(at_end, 0.999)), figure(percentile(at_end, 1))},
                deeper == 0 && (id != "barrier-shell" || ever == 0));
  }
  return section;
}

}  // namespace osteomill::verification
