#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace osteomill::app {

/// Returns the maximum number of tasks in a job array on this cluster. Throws InputError, with the
/// scheduler's own message, if Slurm is missing, does not answer, or does not accept job arrays.
std::size_t slurm_array_limit();

/// Throws InputError if the folder's name cannot be passed to sbatch.
void require_submittable(const std::filesystem::path& folder);

/// Formats ascending numbers as ranges: "1,4-6".
std::string ranges_text(const std::vector<std::size_t>& numbers);

/// Submits these slices of the study in `folder` as job arrays of at most `array_limit` tasks with its
/// submit.sh, and prints the job numbers. Writes submit.sh unless it exists, so users can edit it. Throws
/// InputError with sbatch's message if it refuses; earlier arrays stay submitted.
void submit_to_slurm(const std::filesystem::path& folder, const std::vector<std::size_t>& slices,
                     std::size_t array_limit);

}  // namespace osteomill::app
