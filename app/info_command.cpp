#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/commands.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include <fmt/core.h>

#include "osteomill/ct/scan_summary.h"
#include "osteomill/operator/milling_entry.h"
#include "osteomill/volume/isovalue.h"

namespace osteomill::app {

namespace {

struct InfoOptions {
  ScanOptions scan;
  bool json = false;
};

void run_info(const InfoOptions& options) {
  Scan scan = open_scan(options.scan);
  const SuggestedIsovalue suggested = suggested_isovalue(options.scan, scan);
  const double isovalue = options.scan.isovalue.value_or(suggested.value);
  ScanSummary summary = summarise(scan, suggested, isovalue);
  const auto add = [&](const std::vector<std::string>& warnings) {
    summary.warnings.insert(summary.warnings.end(), warnings.begin(), warnings.end());
  };
  add(isovalue_warnings(scan.grid, isovalue));
  if (is_within(scan.grid, isovalue)) {
    LabelsRead labels = labels_of(options.scan, scan);
    add(labels.warnings);
    Volume bone = bone_of(std::move(scan), isovalue);
    bone.set_labels(std::move(labels.map));
    summary.labels = summarise_labels(bone);
    add(entry_warnings(bone, MillingTool{}, place_entry(bone, MillingTool{})));
  }
  fmt::print("{}", options.json ? to_json(summary) : to_text(summary));
}

}  // namespace

void add_info_command(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = program.add_subcommand("info", "Show what was read of a scan");
  command->group("Scans");
  add_scan_options(*command, options->scan);
  command->add_flag("--json", options->json, "As JSON");
  add_quiet_option(*command);
  command->callback([=] { run_info(*options); });
}

}  // namespace osteomill::app
