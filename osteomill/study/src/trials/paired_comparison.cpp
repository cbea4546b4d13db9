#include "trials/paired_comparison.h"

#include <algorithm>
#include <cmath>

#include "osteomill/study/noticeable.h"

namespace osteomill {

double tremor_effect(const Study& study, const AlgorithmId& algorithm, std::string_view phase,
                     const Field<RunMetrics>& figure) {
  const std::vector<double> values = study.values_by_tremor(algorithm, phase, figure.get);
  std::vector<double> differences;
  for (std::size_t a = 0; a < values.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) differences.push_back(std::abs(values[a] - values[b]));
  return differences.empty() || figure.has(kMachineDependent) ? kNotMeasured
                                                              : distribution_of(differences).median;
}

bool are_compared(const Study& study) {
  return study.algorithms().size() > 1 && study.seeds().size() >= study.seeds_needed();
}

std::size_t tremor_run_count(const Study& study) {
  if (study.phases().empty()) return 0;
  const auto steps = [](const RunMetrics& m) { return m.steps; };
  return study.values_by_tremor(study.algorithms().front(), study.phases().front(), steps).size();
}

std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const Field<RunMetrics>& figure) {
  const std::vector<AlgorithmId> algorithms = study.algorithms();
  std::vector<PairedComparison> comparisons;
  std::vector<double> p;
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    for (std::size_t b = a + 1; b < algorithms.size(); ++b) {
      const std::vector<double> of_first = study.all_values(algorithms[a], phase, figure.get);
      const std::vector<double> of_second = study.all_values(algorithms[b], phase, figure.get);
      std::vector<double> differences, first, second;
      for (std::size_t n = 0; n < std::min(of_first.size(), of_second.size()); ++n) {
        if (std::isnan(of_first[n] - of_second[n])) continue;
        differences.push_back(of_first[n] - of_second[n]);
        first.push_back(of_first[n]);
        second.push_back(of_second[n]);
      }
      if (differences.empty()) continue;
      const SignedRank test = signed_rank(differences);
      PairedComparison& pair = comparisons.emplace_back(
          PairedComparison{algorithms[a], algorithms[b], test.negative > test.positive, differences.size()});
      const double lesser =
          std::min(std::abs(distribution_of(first).median), std::abs(distribution_of(second).median));
      pair.difference = std::abs(distribution_of(differences).median);
      pair.share = pair.difference > 0 ? pair.difference / lesser : 0;
      pair.is_noticeable = pair.difference >= least_noticeable(figure, lesser);
      // False if no other tremors were tried.
      pair.is_less_than_tremor =
          pair.difference < std::fmax(tremor_effect(study, algorithms[a], phase, figure),
                                      tremor_effect(study, algorithms[b], phase, figure));
      p.push_back(test.p);
    }
  }
  const std::vector<double> corrected = holm_corrected(p);
  for (std::size_t n = 0; n < comparisons.size(); ++n) comparisons[n].p = corrected[n];
  return comparisons;
}

}  // namespace osteomill
