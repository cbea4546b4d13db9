#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace osteomill {

/// Returns the cells of each row of a table without quotes, as the program writes it, if its first line is
/// `head`; none if the file does not exist or has another header.
std::vector<std::vector<std::string>> read_csv_table(const std::filesystem::path& path,
                                                     const std::string& head);

}  // namespace osteomill
