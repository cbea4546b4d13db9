#include "osteomill/study/findings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/args.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "osteomill/study/paper.h"

namespace osteomill {

namespace {

// Thresholds of the rules; their texts explain each.
constexpr double kCalmerBy = 2;
constexpr double kGripRatio = 1.25;
constexpr double kFollows = 0.5;
constexpr double kStableShare = 0.2;
constexpr double kMinContacts = 10, kMaxContacts = 20;

double share_hp(const VectorMetrics& v) {
  return v.hp_rms / v.mean;
}

// Figures used by the rules.
using M = RunMetrics;
constexpr auto force_hp = [](const M& m) { return m.force_N.hp_rms; };
constexpr auto torque_hp = [](const M& m) { return m.torque_Nmm.hp_rms; };
constexpr auto torque_step = [](const M& m) { return m.torque_Nmm.step_max; };
constexpr auto torque_share = [](const M& m) { return share_hp(m.torque_Nmm); };
// Ratio of the relative unrest of torque and force.
constexpr auto torque_unrest = [](const M& m) { return share_hp(m.torque_Nmm) / share_hp(m.force_N); };
constexpr auto torque_follows = [](const M& m) { return m.torque_follows_force; };
constexpr auto shaft_spread = [](const M& m) { return m.shaft.spread_deg; };
constexpr auto shaft_turn = [](const M& m) { return m.turns.max_deg; };
constexpr auto shaft_turn_at_torque_step = [](const M& m) { return m.turns.at_torque_step_deg; };
constexpr auto contacts = [](const M& m) { return m.contacts_mean; };

// A figure of one algorithm in one phase that a rule needs.
struct Needed {
  std::size_t algorithm;
  std::string_view phase;
  double (*value)(const RunMetrics&);
};

// Tests a finding on the figures that it needs, in their order; `words` has a {} for each.
struct Rule {
  std::string paper_says;
  std::string rule;
  std::vector<Needed> needed;
  std::string_view words;
  bool (*holds)(const std::vector<double>&);
};

Finding finding_by(const Rule& rule, const RunGroup& group, const WhyNotMeasured& why) {
  Finding finding{rule.paper_says, rule.rule, "needs other recordings", Verdict::not_recorded};
  std::vector<double> values;
  fmt::dynamic_format_arg_store<fmt::format_context> texts;
  std::vector<std::string> not_reached;
  for (const Needed& one : rule.needed) {
    const MeasuredRun* run = group.find(kPapersAlgorithms[one.algorithm - 1], one.phase);
    if (run == nullptr) return finding;
    values.push_back(one.value(run->metrics));
    texts.push_back(std::isnan(values.back()) ? why(*run, one.value) : fmt::format("{:.3g}", values.back()));
    const std::string missed = fmt::format("{}, {}", run->algorithm.label, run->phase);
    if (!run->not_reached.empty() &&
        std::find(not_reached.begin(), not_reached.end(), missed) == not_reached.end())
      not_reached.push_back(missed);
  }
  finding.measured = fmt::vformat(rule.words, texts);
  if (!not_reached.empty())
    finding.measured += fmt::format(" (not all reached: {})", fmt::join(not_reached, "; "));
  const bool known = std::none_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  finding.verdict = !known               ? Verdict::too_little_contact
                    : rule.holds(values) ? Verdict::agrees
                                         : Verdict::does_not_agree;
  return finding;
}

Finding rate_finding(const RunGroup& group) {
  const auto slower = [](const MeasuredRun& a, const MeasuredRun& b) {
    return a.metrics.rate_hz < b.metrics.rate_hz;
  };
  const MeasuredRun& slowest = *std::min_element(group.runs.begin(), group.runs.end(), slower);
  return {"“all the algorithms fulfill the real-time requirements”",
          fmt::format(
              "the rate that a 1 kHz loop would hold with the CPU time of its ticks is {:.0f} Hz or more in "
              "every recording",
              kMinRate_hz),
          fmt::format("lowest {:.1f} Hz ({}, {})", slowest.metrics.rate_hz, name_of(slowest.algorithm),
                      slowest.phase),
          slowest.metrics.rate_hz >= kMinRate_hz ? Verdict::agrees : Verdict::does_not_agree};
}

std::string felt_in_grips(const GripForces& grips) {
  if (std::ranges::all_of(grips, [](const GripForce& grip) { return grip.felt == 0; }))
    return "2 felt a force in no hand while holding, whatever the grip";
  std::vector<std::size_t> felt;
  for (const GripForce& grip : grips) felt.push_back(grip.felt);
  return fmt::format("2 while holding, by grip {:g}: a force felt for long enough in {} of {} hands",
                     fmt::join(kGrips, ", "), fmt::join(felt, ", "), grips.front().hands);
}

Finding grip_finding(const GripForces& grips) {
  Finding finding{
      "2's vibration: “the magnitude is based on how hard the user is holding and gripping the device”",
      fmt::format(
          "from grip to grip of the same hand ({:g} times its stiffness and damping) 2's force above {:.0f} "
          "Hz (rms) while holding increases or decreases monotonically, by a factor of {:g} or more overall",
          fmt::join(kGrips, ", "), kBuzzAbove_hz, kGripRatio),
      "needs three grips", Verdict::not_recorded};
  if (grips.empty()) return finding;
  std::vector<double> forces_N;
  for (const GripForce& grip : grips) forces_N.push_back(grip.hp_rms_N);
  if (std::ranges::any_of(forces_N, [](double v) { return std::isnan(v); })) {
    finding.measured = felt_in_grips(grips);
    finding.verdict = Verdict::too_little_contact;
    return finding;
  }
  finding.measured = fmt::format("2 while holding, by grip {:g}: {:.3g} N", fmt::join(kGrips, ", "),
                                 fmt::join(forces_N, ", "));
  const bool one_way = std::ranges::is_sorted(forces_N) || std::is_sorted(forces_N.rbegin(), forces_N.rend());
  const auto [min, max] = std::ranges::minmax(forces_N);
  finding.verdict = one_way && max >= kGripRatio * min ? Verdict::agrees : Verdict::does_not_agree;
  return finding;
}

// All findings in the order of the paper's text, except for those on the rate and the grip.
const std::array<Rule, kFindings - 2> kRules{
    {{"force: 1 and 3 “more stable than Algorithm #2 independent of case scenario”",
      fmt::format("in both parts 2's force above {:.0f} Hz (rms) is at least {:g} times that of 1 and of 3",
                  kBuzzAbove_hz, kCalmerBy),
      {{1, kMilling, force_hp},
       {2, kMilling, force_hp},
       {3, kMilling, force_hp},
       {1, kHolding, force_hp},
       {2, kHolding, force_hp},
       {3, kHolding, force_hp}},
      "milling 1: {}, 2: {}, 3: {} N; holding 1: {}, 2: {}, 3: {} N",
      [](const auto& v) {
        return v[1] >= kCalmerBy * std::max(v[0], v[2]) && v[4] >= kCalmerBy * std::max(v[3], v[5]);
      }},
     {"1 “kicks away the shaft at a moment”, with “a peak in the torque signal when milling”; the shaft's "
      "jump “occurs at the same time”",
      "while milling 1 has the greatest torque step, and in the 50 ms around it 1's shaft turns further than "
      "the shafts of 2 and 3 in any 50 ms",
      {{1, kMilling, torque_step},
       {2, kMilling, torque_step},
       {3, kMilling, torque_step},
       {1, kMilling, shaft_turn_at_torque_step},
       {2, kMilling, shaft_turn},
       {3, kMilling, shaft_turn}},
      "step 1: {}, 2: {}, 3: {} N mm; turn 1 then: {}, 2 at most: {}, 3 at most: {} degrees",
      [](const auto& v) { return v[0] > std::max(v[1], v[2]) && v[3] > std::max(v[4], v[5]); }},
     {"2's torque seems “to follow the same pattern as for the force feedback, but Algorithm #2 is more "
      "stable than Algorithm #1”",
      fmt::format("in both parts the multiple correlation of 2's torque with its force within 10 ms of it, "
                  "both above {0:.0f} Hz, is {1:g} or more; and its torque above {0:.0f} Hz (rms) is "
                  "less than that of 1 while milling",
                  kBuzzAbove_hz, kFollows),
      {{2, kMilling, torque_follows},
       {2, kHolding, torque_follows},
       {1, kMilling, torque_hp},
       {2, kMilling, torque_hp}},
      "correlation milling {}, holding {}; torque milling 1: {}, 2: {} N mm",
      [](const auto& v) { return std::min(v[0], v[1]) >= kFollows && v[3] < v[2]; }},
     {"3's torque “is a bit more unstable than the force feedback, especially for the milling case”",
      fmt::format("the torque above {:.0f} Hz (rms) as a share of its mean is greater than that of the force "
                  "while milling, and the ratio of the two shares is greater than while holding",
                  kBuzzAbove_hz),
      {{3, kMilling, torque_unrest}, {3, kHolding, torque_unrest}},
      "torque's share / force's share: milling {}, holding {}",
      [](const auto& v) { return v[0] > 1 && v[0] > v[1]; }},
     {"torque: “For the non-milling case both Algorithm #2 and Algorithm #3 give stable torque feedback”",
      fmt::format("while holding, the torque above {:.0f} Hz (rms) of 2 and of 3 is at most {:g} of its mean",
                  kBuzzAbove_hz, kStableShare),
      {{2, kHolding, torque_share}, {3, kHolding, torque_share}},
      "2: {}, 3: {}",
      [](const auto& v) { return std::max(v[0], v[1]) <= kStableShare; }},
     {"shaft: “For the milling case … Algorithm #1 generates a very unstable behavior of the shaft”",
      "while milling the spread of the shaft's direction (rms angle about the mean) is the greatest in 1",
      {{1, kMilling, shaft_spread}, {2, kMilling, shaft_spread}, {3, kMilling, shaft_spread}},
      "1: {}, 2: {}, 3: {} degrees",
      [](const auto& v) { return v[0] > std::max(v[1], v[2]); }},
     {"“an average number of approximately [1]5 points … are really colliding in each haptic loop” with 3",
      fmt::format("while milling {:g} to {:g} points touch, on average over the ticks in contact",
                  kMinContacts, kMaxContacts),
      {{3, kMilling, contacts}},
      "{}",
      [](const auto& v) { return v[0] >= kMinContacts && v[0] <= kMaxContacts; }}}};

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::agrees:
      return "agrees";
    case Verdict::does_not_agree:
      return "does not agree";
    case Verdict::not_settled:
      return "not settled";
    case Verdict::not_recorded:
      return "not recorded";
    case Verdict::too_little_contact:
      return "too little contact";
  }
  return "";
}

std::vector<Finding> check_findings(const RunGroup& group, const GripForces& grips,
                                    const WhyNotMeasured& why) {
  std::vector<Finding> findings{rate_finding(group)};
  for (const Rule& rule : kRules) {
    findings.push_back(finding_by(rule, group, why));
    if (findings.size() == 2) findings.push_back(grip_finding(grips));
  }
  return findings;
}

}  // namespace osteomill
