#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/milled_scan.h"
#include "app/progress.h"
#include <fmt/core.h>

#include "osteomill/ct/write_nrrd.h"
#include "osteomill/files/input_error.h"

namespace osteomill::app {

namespace {

void run_save(const MilledScanOptions& options) {
  if (std::filesystem::path(options.out).extension() != ".nrrd") {
    throw InputError(options.out, "a scan is saved as .nrrd");
  }
  write_nrrd(options.out, load_milled_densities(options));
  fmt::print("{}\n", options.out);
}

}  // namespace

void add_save_command(CLI::App& program) {
  auto options = std::make_shared<MilledScanOptions>();
  CLI::App* command =
      program.add_subcommand("save", "Save the scan, as it was or as milled, as NRRD in the patient's frame");
  command->group("Scans");
  add_milled_scan_options(*command, *options, ".nrrd");
  add_quiet_option(*command);
  command->callback([=] { run_save(*options); });
}

}  // namespace osteomill::app
