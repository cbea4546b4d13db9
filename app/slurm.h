#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace osteomill::app {

/// The greatest number of tasks in an array of jobs on this cluster. Throws InputError, with the scheduler's
/// own words, if there is no Slurm, it does not answer, or it takes no arrays.
std::size_t slurm_array_limit();

/// Throws InputError if submit.sh could not name the folder.
void require_submittable(const std::filesystem::path& folder);

/// "1,4-6".
std::string ranges_text(const std::vector<std::size_t>& numbers);

/// Submits these slices of the study in `folder` as arrays of jobs, each below the limit, by its submit.sh,
/// which is written if there is none yet and is the user's to change, and prints their job numbers. Throws
/// InputError, with sbatch's own words, if it refuses; those before it are submitted then.
void submit_to_slurm(const std::filesystem::path& folder, const std::vector<std::size_t>& slices,
                     std::size_t array_limit);

}  // namespace osteomill::app
