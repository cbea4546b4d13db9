#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/file_lock.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recording.h"
#include "osteomill/study/comparison_report.h"
#include "osteomill/study/write_report.h"

#include "app/commands.h"
#include "app/progress.h"
#include "app/scan_options.h"

namespace osteomill::app {

namespace {

struct ReportOptions {
  std::vector<std::string> recordings;
  std::string out = "osteomill-report";
  bool csv = false;
};

void write_into(const std::filesystem::path& folder, const ReportOptions& options) {
  std::vector<Recording> recordings;
  for (const std::string& path : options.recordings) {
    show_progress("reading",
                  static_cast<double>(recordings.size()) / static_cast<double>(options.recordings.size()));
    Recording recording = read_recording(path);
    if (options.csv) {
      const std::filesystem::path name = recording.path.filename().replace_extension(".csv");
      write_csv(folder / name, recording.records);
    }
    for (Recording& stretch : split_by_setup(std::move(recording))) recordings.push_back(std::move(stretch));
  }
  end_progress();
  if (is_comparison(recordings)) {
    std::vector<Table> result_tables;
    write_comparison_report(recordings, folder, std::nullopt, &result_tables, recorded_scan);
    print_tables(result_tables);
  } else {
    write_report(recordings, folder, recorded_scan);
  }
}

void run_report(const ReportOptions& options) {
  const std::filesystem::path folder = options.out;
  const OutputFolder held(folder);
  write_folder_atomically(folder, [&](const std::filesystem::path& beside) { write_into(beside, options); });
  fmt::print("{}\n", (folder / "report.html").string());
}

}  // namespace

void add_report_command(CLI::App& program) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* command = program.add_subcommand("report", "Write the report of existing recordings");
  command->group("Recordings");
  command->add_option("recordings", options->recordings, "Recordings (.h5) made by compare, live or simulate")
      ->required();
  command->add_option("--out", options->out, "Folder for the report")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->add_flag("--csv", options->csv, "Also write each recording's ticks as CSV");
  add_quiet_option(*command);
  command->callback([=] { run_report(*options); });
}

}  // namespace osteomill::app
