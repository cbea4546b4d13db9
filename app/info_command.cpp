#include <memory>

#include "app/commands.h"
#include "app/scan_options.h"
#include <fmt/core.h>

#include "osteomill/ct/scan_summary.h"

namespace osteomill::app {

namespace {

struct InfoOptions {
  ScanOptions scan;
  bool json = false;
};

void run_info(const InfoOptions& options) {
  const Scan scan = open_scan(options.scan);
  const SuggestedIsovalue suggested = suggested_isovalue(options.scan, scan);
  if (options.scan.isovalue) require_isovalue_within(scan, *options.scan.isovalue);
  const ScanSummary summary = summarise(scan, suggested, options.scan.isovalue.value_or(suggested.value));
  fmt::print("{}", options.json ? to_json(summary) : to_text(summary));
}

}  // namespace

void add_info_command(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = program.add_subcommand("info", "Show what was read of a scan");
  add_scan_options(*command, options->scan);
  command->add_flag("--json", options->json, "As JSON");
  command->callback([=] { run_info(*options); });
}

}  // namespace osteomill::app
