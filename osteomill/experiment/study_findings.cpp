#include "osteomill/experiment/study_findings.h"

#include <cmath>
#include <limits>
#include <optional>

#include "osteomill/experiment/paper.h"

namespace osteomill {

namespace {

// P(Binomial(n, 1/2) >= k).
double chance_of_at_least(std::size_t k, std::size_t n) {
  double exactly = std::ldexp(1.0, -static_cast<int>(n));
  double below = 0;
  for (std::size_t m = 0; m < k; ++m) {
    below += exactly;
    exactly *= static_cast<double>(n - m) / static_cast<double>(m + 1);
  }
  return std::max(0.0, 1 - below);
}

// Not a number where no more than half of the seeds could be measured.
double median_of(const Study& study, const SummaryRow& row, double (*value)(const RunMetrics&)) {
  const std::vector<double> values = study.values(row.algorithm, row.mode, row.segment, {"", "", value});
  return study.are_most(values.size()) ? distribution_of(values).median
                                       : std::numeric_limits<double>::quiet_NaN();
}

// Every metric that a finding looks at.
RunMetrics medians_of(const Study& study, const SummaryRow& row) {
  RunMetrics m;
  m.contact = study.contact({row.algorithm, row.mode}, row.segment);
  m.rate_hz = median_of(study, row, [](const RunMetrics& r) { return r.rate_hz; });
  m.force_N.mean = median_of(study, row, [](const RunMetrics& r) { return r.force_N.mean; });
  m.force_N.hp_rms = median_of(study, row, [](const RunMetrics& r) { return r.force_N.hp_rms; });
  m.torque_Nmm.mean = median_of(study, row, [](const RunMetrics& r) { return r.torque_Nmm.mean; });
  m.torque_Nmm.hp_rms = median_of(study, row, [](const RunMetrics& r) { return r.torque_Nmm.hp_rms; });
  m.torque_Nmm.step_max = median_of(study, row, [](const RunMetrics& r) { return r.torque_Nmm.step_max; });
  m.shaft.spread_deg = median_of(study, row, [](const RunMetrics& r) { return r.shaft.spread_deg; });
  m.turns.max_deg = median_of(study, row, [](const RunMetrics& r) { return r.turns.max_deg; });
  m.turns.at_torque_step_deg =
      median_of(study, row, [](const RunMetrics& r) { return r.turns.at_torque_step_deg; });
  m.torque_follows_force = median_of(study, row, [](const RunMetrics& r) { return r.torque_follows_force; });
  m.contacts_mean = median_of(study, row, [](const RunMetrics& r) { return r.contacts_mean; });
  return m;
}

// Algorithm 2's force above 20 Hz while it is held, in a grip: of one seed, or of all.
std::vector<double> grip_forces(const Study& study, Mode mode, double grip,
                                std::optional<std::uint64_t> seed) {
  std::vector<double> forces;
  for (const auto* rows : {&study.rows(), &study.rows_of_other_grips()}) {
    for (const StudyRow& row : *rows) {
      const SummaryRow& s = row.summary;
      if (row.grip == grip && s.mode == mode && s.segment == kHolding &&
          s.algorithm == kPapersAlgorithms[1] && (!seed || row.seed == *seed)) {
        forces.push_back(s.metrics.force_N.hp_rms);
      }
    }
  }
  return forces;
}

// For each grip the median of those that could be measured; none where a grip was not tried.
GripForces medians_of_grips(const Study& study, Mode mode, std::optional<std::uint64_t> seed) {
  GripForces medians;
  for (const double grip : kGrips) {
    std::vector<double> forces = grip_forces(study, mode, grip, seed);
    if (forces.empty()) return {};
    const std::size_t tried = forces.size();
    std::erase_if(forces, [](double force) { return std::isnan(force); });
    medians.push_back(2 * forces.size() > tried ? distribution_of(forces).median
                                                : std::numeric_limits<double>::quiet_NaN());
  }
  return medians;
}

// Findings ask a recording for its description alone.
std::vector<Finding> findings_of(const std::vector<SummaryRow>& rows, Mode mode, const GripForces& grips) {
  std::vector<Recording> recordings(rows.size());
  RunGroup group{mode, {}};
  for (std::size_t n = 0; n < rows.size(); ++n) {
    RunDescription& d = recordings[n].description;
    d.algorithm = rows[n].algorithm;
    d.mode = rows[n].mode;
    d.segment = rows[n].segment;
    group.runs.push_back({&recordings[n], rows[n].metrics});
  }
  return check_findings(group, grips);
}

std::vector<SummaryRow> summaries(std::span<const StudyRow> rows, Mode mode) {
  std::vector<SummaryRow> of_mode;
  for (const StudyRow& row : rows) {
    if (row.summary.mode == mode) of_mode.push_back(row.summary);
  }
  return of_mode;
}

}  // namespace

std::vector<StudyFinding> check_study_findings(const Study& study, Mode mode) {
  std::vector<SummaryRow> medians = summaries(study.rows_of_seed(0), mode);
  if (medians.empty()) return {};
  for (SummaryRow& row : medians) row.metrics = medians_of(study, row);
  std::vector<StudyFinding> findings;
  for (Finding& finding : findings_of(medians, mode, medians_of_grips(study, mode, {})))
    findings.push_back({std::move(finding)});
  for (std::size_t seed = 0; seed < study.seeds().size(); ++seed) {
    const std::vector<Finding> once = findings_of(summaries(study.rows_of_seed(seed), mode), mode,
                                                  medians_of_grips(study, mode, study.seeds()[seed]));
    for (std::size_t n = 0; n < once.size(); ++n) {
      findings[n].agreeing += once[n].verdict == Verdict::agrees;
      findings[n].tested += is_tested(once[n].verdict);
    }
  }
  for (StudyFinding& finding : findings) finding.p = chance_of_at_least(finding.agreeing, finding.tested);
  return findings;
}

}  // namespace osteomill
