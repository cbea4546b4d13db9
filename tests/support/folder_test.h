#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"
#include "osteomill/ct/read_scan.h"

namespace osteomill::testing_support {

/// A test with its own folder, and helpers for the messages from reading a scan in it.
class FolderTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  /// Returns the error message for the path; empty if it can be read.
  static std::string refusal(const std::filesystem::path& path) {
    try {
      read_scan(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace osteomill::testing_support
