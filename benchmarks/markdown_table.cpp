#include "benchmarks/markdown_table.h"

#include <algorithm>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/core.h>

namespace osteomill::benchmarks {

namespace {

using Run = benchmark::BenchmarkReporter::Run;

struct Row {
  std::string time;
  std::map<std::string, double> counters;
};

Row min_of(const std::vector<const Run*>& runs) {
  const auto fastest = std::min_element(runs.begin(), runs.end(), [](const Run* a, const Run* b) {
    return a->GetAdjustedRealTime() < b->GetAdjustedRealTime();
  });
  Row row{fmt::format("{:.4g} {}", (*fastest)->GetAdjustedRealTime(),
                      benchmark::GetTimeUnitString((*fastest)->time_unit)),
          {}};
  for (const Run* run : runs) {
    for (const auto& [name, counter] : run->counters) {
      const auto [at, is_new] = row.counters.try_emplace(name, counter.value);
      if (!is_new) at->second = std::min(at->second, counter.value);
    }
  }
  return row;
}

std::string take(std::map<std::string, double>& counters, const std::string& name) {
  const auto found = counters.find(name);
  if (found == counters.end()) return "";
  const std::string text = fmt::format("{:.4g}", found->second);
  counters.erase(found);
  return text;
}

}  // namespace

bool MarkdownTable::ReportContext(const Context&) {
  GetOutputStream() << "| benchmark | time | p50 us | p99 us | max us | more |\n|---|---|---|---|---|---|\n";
  return true;
}

void MarkdownTable::ReportRuns(const std::vector<Run>& runs) {
  std::vector<const Run*> good;
  for (const Run& run : runs) {
    if (run.run_type == Run::RT_Iteration && !run.error_occurred) good.push_back(&run);
  }
  if (good.empty()) return;
  Row row = min_of(good);
  std::string name = good.front()->run_name.function_name;
  if (!good.front()->run_name.args.empty()) name += "/" + good.front()->run_name.args;
  const std::string p50 = take(row.counters, "p50_us"), p99 = take(row.counters, "p99_us"),
                    max = take(row.counters, "max_us");
  std::string more;
  for (const auto& [counter, value] : row.counters) more += fmt::format("{} {:.4g}; ", counter, value);
  GetOutputStream() << fmt::format("| {} | {} | {} | {} | {} | {} |\n", name, row.time, p50, p99, max, more);
  GetOutputStream().flush();
}

}  // namespace osteomill::benchmarks
