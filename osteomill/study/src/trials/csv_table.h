#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace osteomill {

/// Returns the cells of each row of a table without quotes whose first line is `head`, as the program writes
/// them; none if there is no such file or it has another head.
std::vector<std::vector<std::string>> read_csv_table(const std::filesystem::path& path,
                                                     const std::string& head);

}  // namespace osteomill
