#include "app/scan_options.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/core.h>

#include "osteomill/ct/read_scan.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"
#include "osteomill/volume/builtin_tooth.h"

namespace osteomill::app {

void add_scan_options(CLI::App& command, ScanOptions& options) {
  command.add_option("scan", options.scan,
                     "DICOM folder or file, NRRD, MetaImage or NIfTI; without one, the built-in tooth");
  command.add_option("--iso", options.isovalue, "Isovalue: bone where the density is greater");
}

Scan open_scan(const ScanOptions& options) {
  if (!options.scan.empty()) return read_scan(options.scan);
  return {builtin_tooth(), "built-in tooth", "made up", {}};
}

SuggestedIsovalue suggested_isovalue(const ScanOptions& options, const Scan& scan) {
  if (options.scan.empty()) return {kBuiltinToothIsovalue, "halfway between air and the tooth's dentine"};
  return suggest_isovalue(scan.grid, scan.in_hounsfield_units);
}

SuggestedIsovalue chosen_isovalue(const ScanOptions& options, const Scan& scan) {
  if (options.isovalue) return {*options.isovalue, "given"};
  return suggested_isovalue(options, scan);
}

void require_isovalue_within(const Scan& scan, double isovalue) {
  const std::vector<float>& densities = scan.grid.densities();
  const float* min = densities.data();
  const float* max = min;
  constexpr std::size_t kAtOnce = 1 << 22;
  for (std::size_t n = 0; n < densities.size(); n += kAtOnce) {
    const float* const end = densities.data() + std::min(n + kAtOnce, densities.size());
    const auto [low, high] = std::minmax_element(&densities[n], end);
    if (*low < *min) min = low;
    if (*high > *max) max = high;
    WorkProgress::done(n, 2 * densities.size());
  }
  if (isovalue < static_cast<double>(*max) && isovalue >= static_cast<double>(*min)) return;
  throw InputError(scan.name, fmt::format("the isovalue {:g} lies outside its values, {:g} to {:g}", isovalue,
                                          *min, *max));
}

void print_warnings(const Scan& scan) {
  for (const std::string& warning : scan.warnings) {
    fmt::print(stderr, "osteomill: {}: warning: {}\n", scan.name, warning);
  }
}

LoadedBone load_bone(const ScanOptions& options) {
  Scan scan = [&] {
    const WorkProgress::Part reading(0.75);
    return open_scan(options);
  }();
  print_warnings(scan);
  SuggestedIsovalue isovalue = chosen_isovalue(options, scan);
  const WorkProgress::Part looking(1);
  if (!options.isovalue && !options.scan.empty()) {
    fmt::print(stderr, "osteomill: {}: isovalue {:g} suggested, {}; --iso sets another\n", scan.name,
               isovalue.value, isovalue.how);
  }
  require_isovalue_within(scan, isovalue.value);
  return {Volume(std::move(scan.grid), isovalue.value), scan.name, std::move(isovalue.how)};
}

}  // namespace osteomill::app
