#include "osteomill/experiment/findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "osteomill/experiment/paper.h"

namespace osteomill {

namespace {

constexpr std::string_view k3 = kPapersAlgorithms[2];

constexpr double kBuzzRatio = 2.0;
constexpr double kRestlessRatio = 1.5;

// A value for each of the paper's algorithms, in its order.
using PapersThree = std::array<double, kPapersAlgorithms.size()>;
using Measure = std::function<double(const RunMetrics&)>;

const Measure kForceBuzz = [](const RunMetrics& m) { return m.force_N.hp_rms; };
const Measure kTorqueBuzz = [](const RunMetrics& m) { return m.torque_Nmm.hp_rms; };
const Measure kTorqueStep = [](const RunMetrics& m) { return m.torque_Nmm.step_max; };
const Measure kShaftSpread = [](const RunMetrics& m) { return m.shaft.spread_deg; };

std::string during(std::string_view phase) {
  return phase == kMilling ? "while milling" : "while holding";
}

using ThreeRuns = std::array<const MeasuredRun*, kPapersAlgorithms.size()>;

// The runs of all three algorithms in a phase, or nothing where one is missing.
std::optional<ThreeRuns> of_all(const RunGroup& group, std::string_view phase) {
  ThreeRuns runs{};
  for (std::size_t n = 0; n < kPapersAlgorithms.size(); ++n) {
    runs[n] = group.find(kPapersAlgorithms[n], phase);
    if (runs[n] == nullptr) return std::nullopt;
  }
  return runs;
}

// "0.012", or "lost contact after 3.2 s".
std::string value_text(const MeasuredRun& run, const Measure& measure) {
  const double value = measure(run.metrics);
  return std::isnan(value) ? contact_words(run.metrics.contact) : fmt::format("{:.3g}", value);
}

Verdict verdict_of(bool agrees) {
  return agrees ? Verdict::agrees : Verdict::does_not_agree;
}

// A finding about the three algorithms of one phase.
Finding compare_three(const RunGroup& group, std::string_view phase, const Measure& measure, const char* unit,
                      std::string paper_says, std::string rule,
                      const std::function<bool(const PapersThree&)>& holds) {
  Finding finding{std::move(paper_says), std::move(rule), "needs all three algorithms",
                  Verdict::not_recorded};
  if (const auto runs = of_all(group, phase)) {
    PapersThree v{};
    for (std::size_t n = 0; n < v.size(); ++n) v[n] = measure((*runs)[n]->metrics);
    finding.measured = fmt::format("1: {}, 2: {}, 3: {} {}", value_text(*(*runs)[0], measure),
                                   value_text(*(*runs)[1], measure), value_text(*(*runs)[2], measure), unit);
    const bool known = std::none_of(v.begin(), v.end(), [](double value) { return std::isnan(value); });
    finding.verdict = known ? verdict_of(holds(v)) : Verdict::lost_contact;
  }
  return finding;
}

Finding rate_finding(const RunGroup& group) {
  const auto slower = [](const MeasuredRun& a, const MeasuredRun& b) {
    return a.metrics.rate_hz < b.metrics.rate_hz;
  };
  const MeasuredRun& slowest = *std::min_element(group.runs.begin(), group.runs.end(), slower);
  const RunDescription& d = slowest.recording->description;
  return {"Every algorithm holds the haptic rate",
          fmt::format(
              "the rate that a 1 kHz loop would hold with the CPU time of its ticks is {:.0f} Hz or more in "
              "every recording",
              kMinRate_hz),
          fmt::format("lowest {:.1f} Hz ({}, {})", slowest.metrics.rate_hz, name_of(d.algorithm),
                      during(d.segment)),
          verdict_of(slowest.metrics.rate_hz >= kMinRate_hz), true};
}

Finding force_finding(const RunGroup& group, std::string_view phase) {
  return compare_three(
      group, phase, kForceBuzz, "N", fmt::format("Force {}: 1 and 3 are steady, 2 buzzes", during(phase)),
      fmt::format("the force above {:.0f} Hz (rms) of 2 is at least {} times that of 1 and of 3",
                  kBuzzAbove_hz, kBuzzRatio),
      [](const auto& v) { return v[1] >= kBuzzRatio * v[0] && v[1] >= kBuzzRatio * v[2]; });
}

Finding worst_torque_finding(const RunGroup& group, std::string_view phase) {
  return compare_three(
      group, phase, kTorqueBuzz, "N mm", fmt::format("Torque {}: 1 is the worst, 2 is better", during(phase)),
      fmt::format("the torque above {:.0f} Hz (rms) of 1 is the greatest of the three", kBuzzAbove_hz),
      [](const auto& v) { return v[0] > v[1] && v[0] > v[2]; });
}

Finding kick_finding(const RunGroup& group) {
  return compare_three(group, kMilling, kTorqueStep, "N mm",
                       "Torque while milling: the shaft is kicked away in 1, with a peak",
                       "the greatest change of torque from one tick to the next is that of 1",
                       [](const auto& v) { return v[0] > v[1] && v[0] > v[2]; });
}

Finding best_torque_finding(const RunGroup& group) {
  return compare_three(
      group, kHolding, kTorqueBuzz, "N mm", "Torque while holding: 3 is the best",
      fmt::format("the torque above {:.0f} Hz (rms) of 3 is the least of the three", kBuzzAbove_hz),
      [](const auto& v) { return v[2] < v[0] && v[2] < v[1]; });
}

Finding restless_finding(const RunGroup& group) {
  Finding finding{
      "Torque of 3: a little restless while milling",
      fmt::format("its torque above {:.0f} Hz (rms) is at least {} times as great while milling as "
                  "while holding",
                  kBuzzAbove_hz, kRestlessRatio),
      "needs both phases of 3", Verdict::not_recorded};
  const MeasuredRun* milling = group.find(k3, kMilling);
  const MeasuredRun* holding = group.find(k3, kHolding);
  if (milling != nullptr && holding != nullptr) {
    const double moving = kTorqueBuzz(milling->metrics);
    const double still = kTorqueBuzz(holding->metrics);
    finding.measured = fmt::format("milling: {}, holding: {} N mm", value_text(*milling, kTorqueBuzz),
                                   value_text(*holding, kTorqueBuzz));
    finding.verdict = std::isnan(moving) || std::isnan(still)
                          ? Verdict::lost_contact
                          : verdict_of(moving > 0 && moving >= kRestlessRatio * still);
  }
  return finding;
}

Finding shaft_finding(const RunGroup& group, std::string_view phase) {
  return compare_three(group, phase, kShaftSpread, "degrees",
                       fmt::format("Shaft direction {}: 3 is the most compact", during(phase)),
                       "the spread (rms angle about the mean direction) of 3 is the least of the three",
                       [](const auto& v) { return v[2] < v[0] && v[2] < v[1]; });
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::agrees:
      return "agrees";
    case Verdict::does_not_agree:
      return "does not agree";
    case Verdict::not_recorded:
      return "not recorded";
    case Verdict::lost_contact:
      return "lost contact";
  }
  return "";
}

std::vector<Finding> check_findings(const RunGroup& group) {
  std::vector<Finding> findings{rate_finding(group)};
  for (const std::string_view phase : kPhases) findings.push_back(force_finding(group, phase));
  for (const std::string_view phase : kPhases) findings.push_back(worst_torque_finding(group, phase));
  findings.push_back(kick_finding(group));
  findings.push_back(best_torque_finding(group));
  findings.push_back(restless_finding(group));
  for (const std::string_view phase : kPhases) findings.push_back(shaft_finding(group, phase));
  return findings;
}

}  // namespace osteomill
