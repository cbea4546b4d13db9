#pragma once

#include <vector>

#include <benchmark/benchmark.h>

namespace osteomill::benchmarks {

/// Writes results as rows of a Markdown table: of several repetitions the least time and the least of every
/// counter, since whatever else the machine does only ever adds.
class MarkdownTable final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
};

}  // namespace osteomill::benchmarks
