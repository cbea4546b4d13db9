#include "trials/study_comparison.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

using Pairs = std::vector<std::pair<AlgorithmId, AlgorithmId>>;

std::vector<PairedComparison> compare(const Study& study, const Pairs& pairs, std::string_view phase,
                                      const RunFigure& figure) {
  std::vector<PairedComparison> comparisons;
  std::vector<double> p;
  for (const auto& [first, second] : pairs) {
    const std::vector<double> of_first = study.all_values(first, phase, figure);
    const std::vector<double> of_second = study.all_values(second, phase, figure);
    std::vector<double> a, b, differences, ratios;
    for (std::size_t n = 0; n < std::min(of_first.size(), of_second.size()); ++n) {
      if (std::isnan(of_first[n]) || std::isnan(of_second[n])) continue;
      a.push_back(of_first[n]);
      b.push_back(of_second[n]);
      differences.push_back(a.back() - b.back());
      if (a.back() != 0) ratios.push_back(b.back() / a.back());
    }
    if (a.empty()) continue;
    const SignedRank test = signed_rank(differences);
    comparisons.push_back({first, second, a.size(), median_interval(a), median_interval(b),
                           median_interval(ratios), ratios.size(), test.negative > test.positive});
    p.push_back(test.p);
  }
  const std::vector<double> corrected = holm_corrected(p);
  for (std::size_t n = 0; n < comparisons.size(); ++n) comparisons[n].p = corrected[n];
  return comparisons;
}

}  // namespace

std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const RunFigure& figure) {
  const std::vector<AlgorithmId> algorithms = study.algorithms();
  Pairs pairs;
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    for (std::size_t b = a + 1; b < algorithms.size(); ++b) pairs.emplace_back(algorithms[a], algorithms[b]);
  }
  return compare(study, pairs, phase, figure);
}

}  // namespace osteomill
