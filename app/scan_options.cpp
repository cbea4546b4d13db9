#include "app/scan_options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/core.h>

#include "osteomill/ct/read_scan.h"
#include "osteomill/files/input_error.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/densities.h"

namespace osteomill::app {

namespace {

void require_bone_and_surroundings(const DensityGrid& grid, double isovalue, const std::string& name) {
  const auto [least, greatest] = std::minmax_element(grid.densities().begin(), grid.densities().end());
  if (isovalue < static_cast<double>(*greatest) && isovalue >= static_cast<double>(*least)) return;
  throw InputError(name, fmt::format("the isovalue {:g} lies outside its values, {:g} to {:g}", isovalue,
                                     *least, *greatest));
}

}  // namespace

void add_scan_options(CLI::App& command, ScanOptions& options) {
  command.add_option("scan", options.scan,
                     "DICOM folder or file, NRRD, MetaImage or NIfTI; without one, the built-in tooth");
  command.add_option("--iso", options.isovalue, "Isovalue: bone where the density is greater");
}

LoadedBone load_bone(const ScanOptions& options) {
  if (options.scan.empty()) {
    const double isovalue = options.isovalue.value_or(kBuiltinToothIsovalue);
    DensityGrid tooth = builtin_tooth();
    require_bone_and_surroundings(tooth, isovalue, "built-in tooth");
    return {Volume(std::move(tooth), isovalue), "built-in tooth"};
  }
  Scan scan = read_scan(options.scan);
  for (const std::string& warning : scan.warnings) {
    fmt::print(stderr, "osteomill: {}: warning: {}\n", scan.name, warning);
  }
  double isovalue = 0;
  if (options.isovalue) {
    isovalue = *options.isovalue;
  } else {
    isovalue = suggest_isovalue(scan.grid);
    fmt::print(stderr, "osteomill: {}: isovalue {:g} suggested from its values; --iso sets another\n",
               scan.name, isovalue);
  }
  require_bone_and_surroundings(scan.grid, isovalue, scan.name);
  return {Volume(std::move(scan.grid), isovalue), scan.name};
}

}  // namespace osteomill::app
