#pragma once

#include <vector>

#include <benchmark/benchmark.h>

namespace osteomill::benchmarks {

/// Writes results as rows of a Markdown table: the minimum of the repetitions for the time and each counter,
/// because other work on the machine only adds time.
class MarkdownTable final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
};

}  // namespace osteomill::benchmarks
