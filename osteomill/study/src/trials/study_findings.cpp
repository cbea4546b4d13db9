#include "osteomill/study/study_findings.h"

#include <cmath>
#include <optional>

#include "osteomill/study/paper.h"

#include "trials/statistics.h"

namespace osteomill {

namespace {

// Returns the probability of at least k heads in n coin tosses.
double chance_of_at_least(std::size_t k, std::size_t n) {
  return std::max(0.0, 1 - chance_of_fewer_heads(k, n));
}

Verdict verdict_of(const StudyFinding& finding, const Study& study) {
  const auto shows = [&](std::size_t hands) {
    return chance_of_at_least(hands, finding.tested) <= kSignificance;
  };
  if (!is_tested(finding.of_medians.verdict)) return finding.of_medians.verdict;
  if (!study.are_most(finding.tested)) return Verdict::too_little_contact;
  if (shows(finding.agreeing)) return Verdict::agrees;
  return shows(finding.tested - finding.agreeing) ? Verdict::does_not_agree : Verdict::not_settled;
}

// Returns the medians over the seeds; NaN if at most half of them could be measured.
RunMetrics medians_of(const Study& study, const MeasuredRun& run) {
  RunMetrics medians;
  for (const Field<RunMetrics>& figure : fields_of<RunMetrics>()) {
    const std::vector<double> values = study.values(run.algorithm, run.phase, figure.get);
    figure.set(medians, study.are_most(values.size()) ? distribution_of(values).median : kNotMeasured);
  }
  return medians;
}

// Returns algorithm 2's force above 20 Hz while holding in a grip, for one seed or for all.
std::vector<double> grip_forces(const Study& study, double grip, std::optional<std::uint64_t> seed) {
  std::vector<double> forces;
  for (const auto* rows : {&study.rows(), &study.extra_rows()}) {
    for (const MeasuredRun& run : *rows) {
      if (run.grip == grip && run.other_tremor == 0 && run.phase == kHolding &&
          run.algorithm == kPapersAlgorithms[1] && (!seed || run.seed == *seed)) {
        forces.push_back(run.metrics.force_N.hp_rms);
      }
    }
  }
  return forces;
}

// Returns the median over the measured hands for each grip; empty if a grip was not tried.
GripForces medians_of_grips(const Study& study, std::optional<std::uint64_t> seed) {
  GripForces medians;
  for (const double grip : kGrips) {
    std::vector<double> forces = grip_forces(study, grip, seed);
    if (forces.empty()) return {};
    const std::size_t tried = forces.size();
    std::erase_if(forces, [](double force) { return std::isnan(force); });
    medians.push_back(
        {2 * forces.size() > tried ? distribution_of(forces).median : kNotMeasured, forces.size(), tried});
  }
  return medians;
}

RunGroup runs_of(std::span<const MeasuredRun> rows) {
  return {{rows.begin(), rows.end()}};
}

}  // namespace

std::vector<StudyFinding> check_study_findings(const Study& study) {
  RunGroup medians = runs_of(study.rows_of_seed(0));
  for (MeasuredRun& run : medians.runs) {
    run.metrics = medians_of(study, run);
    run.not_reached = study.not_reached(run.algorithm, run.phase);
  }
  std::vector<StudyFinding> findings;
  const auto why = [&](const MeasuredRun& run, double (*figure)(const RunMetrics&)) {
    return study.why_not_measured(run.algorithm, run.phase, figure);
  };
  for (Finding& finding : check_findings(medians, medians_of_grips(study, {}), why))
    findings.push_back({std::move(finding)});
  for (std::size_t seed = 0; seed < study.seeds().size(); ++seed) {
    const std::vector<Finding> once =
        check_findings(runs_of(study.rows_of_seed(seed)), medians_of_grips(study, study.seeds()[seed]));
    for (std::size_t n = 0; n < once.size(); ++n) {
      findings[n].agreeing += once[n].verdict == Verdict::agrees;
      findings[n].tested += is_tested(once[n].verdict);
    }
  }
  for (StudyFinding& finding : findings) {
    finding.p = chance_of_at_least(finding.agreeing, finding.tested);
    finding.verdict = verdict_of(finding, study);
  }
  return findings;
}

}  // namespace osteomill
