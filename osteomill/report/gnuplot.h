#pragma once

#include <filesystem>
#include <string>

namespace osteomill {

/// Runs `script` in a child process of `program` whose working folder is `folder`. Throws InputError where
/// gnuplot is not installed, or, with its own last word, where it fails.
void run_gnuplot(const std::filesystem::path& folder, const std::string& script,
                 const std::string& program = "gnuplot");

/// `text` between quotes that gnuplot takes as they are, without line breaks and other control characters.
std::string gnuplot_quoted(const std::string& text);

}  // namespace osteomill
