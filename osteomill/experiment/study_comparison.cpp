#include "osteomill/experiment/study_comparison.h"

#include "osteomill/experiment/statistics.h"

namespace osteomill {

namespace {

SignedRank paired_test(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> differences;
  for (std::size_t n = 0; n < first.size(); ++n) differences.push_back(first[n] - second[n]);
  return signed_rank(differences);
}

template <typename Comparison>
void correct(std::vector<Comparison>& comparisons) {
  std::vector<double> p;
  for (const Comparison& comparison : comparisons) p.push_back(comparison.p);
  const std::vector<double> corrected = holm_corrected(p);
  for (std::size_t n = 0; n < comparisons.size(); ++n) comparisons[n].p = corrected[n];
}

}  // namespace

std::vector<AlgorithmPair> compare_algorithms(const Study& study, Mode mode, std::string_view phase,
                                              const RunFigure& figure) {
  const std::vector<AlgorithmId> algorithms = study.algorithms();
  std::vector<AlgorithmPair> pairs;
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    for (std::size_t b = a + 1; b < algorithms.size(); ++b) {
      const auto [first, second] =
          study.paired_values({algorithms[a], mode}, {algorithms[b], mode}, phase, figure);
      if (first.empty() || second.empty()) continue;
      const SignedRank test = paired_test(first, second);
      pairs.push_back({algorithms[a], algorithms[b],
                       test.negative > test.positive ? algorithms[b] : algorithms[a], test.p});
    }
  }
  correct(pairs);
  return pairs;
}

std::vector<ModeChange> compare_modes(const Study& study, std::string_view phase, const RunFigure& figure) {
  std::vector<ModeChange> changes;
  for (const AlgorithmId& algorithm : study.algorithms()) {
    const auto [paper, steady] =
        study.paired_values({algorithm, Mode::paper}, {algorithm, Mode::steady}, phase, figure);
    if (paper.empty() || steady.empty()) continue;
    std::vector<double> ratios;
    for (std::size_t n = 0; n < paper.size(); ++n) {
      if (paper[n] != 0) ratios.push_back(steady[n] / paper[n]);
    }
    const SignedRank test = paired_test(steady, paper);
    changes.push_back({algorithm, paper.size(), median_interval(paper), median_interval(steady),
                       median_interval(ratios), ratios.size(), test.negative > test.positive, test.p});
  }
  correct(changes);
  return changes;
}

}  // namespace osteomill
