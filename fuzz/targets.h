#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace osteomill::fuzzing {

using Bytes = std::span<const unsigned char>;

/// One way by which bytes that we did not make come in.
struct Target {
  const char* name;
  /// Reads `bytes`, by files in `folder` if it has to. Ends in a result or an InputError.
  std::function<void(Bytes bytes, const std::filesystem::path& folder)> read;
  /// Sound inputs to begin from, made in `folder`.
  std::function<std::vector<std::string>(const std::filesystem::path& folder)> seeds;
};

const std::vector<Target>& targets();

/// Parts of `targets`: files of volumes, archives and labels; DICOM, by its elements and by each decoder;
/// trajectories, configurations, recordings and the files of studies.
std::vector<Target> volume_targets();
std::vector<Target> dicom_targets();
std::vector<Target> run_targets();
/// Files of studies, and trajectories along which every algorithm is driven.
std::vector<Target> study_file_targets();

/// Reads a scan, in little memory, and makes of it what `osteomill info` tells. Pictures are 1 mm apart.
void read_as_info_does(const std::filesystem::path& path, bool are_pictures = false);

void write_bytes(const std::filesystem::path& file, Bytes bytes);
std::string read_bytes(const std::filesystem::path& file);

}  // namespace osteomill::fuzzing
