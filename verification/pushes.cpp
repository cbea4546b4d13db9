#include "verification/pushes.h"

#include <cmath>

#include "osteomill/session/hand.h"
#include "osteomill/session/simulated_handle.h"

#include "verification/in_parallel.h"
#include "verification/probing.h"

namespace osteomill::verification {

namespace {

constexpr std::size_t kBatch = 250;

// A straight approach of the tool from free space.
struct Push {
  Pose X_W_start;
  Vec3 direction_W;
  double force_N;
  double speed_mm_s;
};

// Returns a push towards a random surface point, in a random direction and orientation, that starts shortly
// before contact.
Push random_push(const BoneSurface& surface, const PushKind& kind, SeededRandom& random) {
  const MillingTool& tool = kind.tool;
  Push push;
  const auto count = static_cast<double>(surface.points().size());
  const Vec3 aim = surface.points()[static_cast<std::size_t>(random.uniform(0, count))];
  push.direction_W = random_direction(random);
  push.X_W_start.orientation = random_orientation(random);
  push.force_N = random.uniform(kind.min_N, kind.max_N);
  push.speed_mm_s = random.uniform(kind.min_mm_s, kind.max_mm_s);
  // Brings a tool grown by 0.3 mm from far outside to its first contact.
  const MillingTool grown{tool.burr_radius_mm + 0.3, tool.shaft_radius_mm + 0.3, tool.shaft_length_mm + 0.3};
  for (double back_mm = 45; back_mm > 0; back_mm -= 0.5) {
    const Vec3 next = aim - back_mm * push.direction_W;
    if (surface.deepest_mm(grown, {next, push.X_W_start.orientation}) > 0) break;
    push.X_W_start.position_mm = next;
  }
  return push;
}

void record(PushOutcome& outcome, const BoneSurface& surface, const MillingTool& tool,
            const HapticStep& step) {
  outcome.centreline.record(surface.centreline_depth_mm(tool, step.X_WT));
  outcome.tool.record(surface.deepest_mm(tool, step.X_WT));
}

PushOutcome run_push(const Push& push, HapticAlgorithm& algorithm, const BoneSurface& surface,
                     const MillingTool& tool) {
  algorithm.reset();
  HandSettings hand;
  hand.push_N = push.force_N;
  SimulatedHandle handle(HandleSettings{}, push.X_W_start);
  const double travel_mm = 1 + 1.2 * push.force_N / hand.stiffness_N_per_mm;
  const int moving = static_cast<int>(travel_mm / (push.speed_mm_s * kTick_s));
  const int substeps = static_cast<int>(kTick_s / handle.settings().substep_s + 0.5);
  PushOutcome outcome;
  Pose target = push.X_W_start;
  for (int n = 0; n < moving + 150; ++n) {
    const HapticStep step = algorithm.step(handle.read(), kTick_s);
    handle.command(make_safe(step.wrench, WrenchLimits{}).wrench);
    if (n % kTicksBetweenChecks == 0) record(outcome, surface, tool, step);
    const Twist velocity{n < moving ? Vec3(push.speed_mm_s * push.direction_W) : Vec3::Zero(), Vec3::Zero()};
    target.position_mm += kTick_s * velocity.linear_mm_s;
    for (int substep = 0; substep < substeps; ++substep) {
      handle.advance(hand_wrench(hand, target, velocity, handle.pose(), handle.velocity()));
    }
  }
  return outcome;
}

}  // namespace

std::vector<PushOutcome> push_outcomes(std::string_view algorithm, const Volume& bone,
                                       const BoneSurface& surface, const PushKind& kind, int count) {
  std::vector<PushOutcome> all(static_cast<std::size_t>(count));
  in_parallel((all.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const auto made = make_algorithm(algorithm_named(algorithm), {});
    made->prepare({&bone, kind.tool});
    SeededRandom random(100 + batch);
    for (std::size_t n = batch * kBatch; n < std::min(all.size(), (batch + 1) * kBatch); ++n) {
      all[n] = run_push(random_push(surface, kind, random), *made, surface, kind.tool);
    }
  });
  return all;
}

std::size_t count_deeper(const std::vector<PushOutcome>& all, Depth PushOutcome::*what, double Depth::*when,
                         double limit_mm) {
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](const PushOutcome& one) { return one.*what.*when > limit_mm; }));
}

}  // namespace osteomill::verification
