#include "app/slurm.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/run_program.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

// Returns a program's output. Throws InputError with its last line if it fails.
std::string output_of(const std::vector<std::string>& words) {
  ProcessResult result = run_program(words);
  if (result.exit_code == ProcessResult::kNoProgram)
    throw InputError(words.front(), "is not installed, but --on slurm needs it (package slurm-client)");
  while (!result.text.empty() && result.text.back() == '\n') result.text.pop_back();
  if (result.exit_code == 0) return result.text;
  std::string last = result.text.substr(result.text.rfind('\n') + 1);
  const std::string before = words.front() + ": error: ";
  if (last.starts_with(before)) last.erase(0, before.size());
  throw InputError(words.front(), last.empty() ? "failed" : last);
}

void write_submit_script(const fs::path& folder) {
  const fs::path script = folder / "submit.sh";
  std::error_code error;
  if (fs::exists(script, error)) return;
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  write_text_atomically(script, [&](std::ostream& out) {
    fmt::print(
        out,
        "#!/bin/sh\n"
        "# Runs one slice of a study per array task. osteomill study passes it to sbatch with the number of "
        "the\n"
        "# array's first slice and --chdir, so paths are relative to this folder, which may be moved.\n"
        "# You may edit this file; it is not overwritten.\n"
        "#SBATCH --job-name=osteomill\n"
        "#SBATCH --cpus-per-task=1\n"
        "#SBATCH --output=logs/%A_%a.txt\n"
        "##SBATCH --account=...\n"
        "##SBATCH --partition=...\n"
        "##SBATCH --time=0:30:00\n"
        "##SBATCH --mem-per-cpu=1G\n"
        "slice=$(($1 + SLURM_ARRAY_TASK_ID))\n"
        "exec {} study . --slice \"$slice\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\" --quiet\n",
        quoted(program));
  });
}

}  // namespace

// A #SBATCH line can contain neither a line break nor a quotation mark.
void require_submittable(const fs::path& folder) {
  const std::string name = fs::absolute(folder).lexically_normal().string();
  if (name.find('"') != std::string::npos || in_one_line(name) != name)
    throw InputError(name, "has a quotation mark or a line break in its name, which sbatch cannot handle");
}

std::string ranges_text(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t n = 0; n < numbers.size();) {
    std::size_t last = n;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[n]);
    if (last > n) text += fmt::format("-{}", numbers[last]);
    n = last + 1;
  }
  return text;
}

std::size_t slurm_array_limit() {
  output_of({"sbatch", "--version"});
  const std::string config = output_of({"scontrol", "show", "config"});
  constexpr std::string_view kKey = "MaxArraySize";
  const std::size_t at = config.find(kKey);
  const std::size_t digits =
      at == std::string::npos ? at : config.find_first_of("0123456789", at + kKey.size());
  std::size_t limit = 0;
  if (digits != std::string::npos)
    std::from_chars(config.data() + digits, config.data() + config.size(), limit);
  // An array's tasks are numbered from 0 to MaxArraySize - 1.
  if (limit < 2) throw InputError("slurm", "does not accept job arrays here (MaxArraySize)");
  return limit;
}

void submit_to_slurm(const fs::path& folder, const std::vector<std::size_t>& slices,
                     std::size_t array_limit) {
  const fs::path study = fs::absolute(folder).lexically_normal();
  require_submittable(study);
  create_folder(study / "logs");
  write_submit_script(study);
  for (auto from = slices.begin(); from != slices.end();) {
    const std::size_t first = *from - *from % array_limit;
    const auto to = std::lower_bound(from, slices.end(), first + array_limit);
    std::vector<std::size_t> tasks;
    for (; from != to; ++from) tasks.push_back(*from - first);
    const std::string array = "--array=" + ranges_text(tasks);
    fmt::print("submitted as job {}\n",
               output_of({"sbatch", "--parsable", "--chdir=" + study.string(), array,
                          (study / "submit.sh").string(), fmt::format("{}", first)}));
  }
}

}  // namespace osteomill::app
