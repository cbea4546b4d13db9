// Prints a Markdown table; --benchmark_out=FILE writes JSON with every repetition.

#include "benchmarks/markdown_table.h"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  osteomill::benchmarks::MarkdownTable table;
  benchmark::RunSpecifiedBenchmarks(&table);
  return 0;
}
