#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace osteomill::fuzzing {

using Bytes = std::span<const unsigned char>;

/// A fuzz target: one reader of untrusted bytes.
struct Target {
  const char* name;
  /// Reads `bytes`, through files in `folder` if needed. Must return or throw InputError.
  std::function<void(Bytes bytes, const std::filesystem::path& folder)> read;
  /// Returns valid seed inputs, made in `folder`.
  std::function<std::vector<std::string>(const std::filesystem::path& folder)> seeds;
};

const std::vector<Target>& targets();

/// Parts of `targets`: volume files, archives and labels; DICOM, by its elements and by each decoder;
/// trajectories, configurations, recordings and slices of studies.
std::vector<Target> volume_targets();
std::vector<Target> dicom_targets();
std::vector<Target> run_targets();
/// Study files, and trajectories along which every algorithm is driven.
std::vector<Target> study_file_targets();

/// Reads a scan with a low memory limit and computes the summary of `osteomill info`. Images are 1 mm apart.
void read_as_info_does(const std::filesystem::path& path, bool are_pictures = false);

void write_bytes(const std::filesystem::path& file, Bytes bytes);
std::string read_bytes(const std::filesystem::path& file);

}  // namespace osteomill::fuzzing
