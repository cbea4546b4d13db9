#pragma once

#include <optional>
#include <string_view>

namespace osteomill {

/// `paper` is what the paper says; `steady` the same algorithm with named improvements.
enum class Mode : unsigned char { paper, steady };

/// As written on the command line and in files: "paper", "steady".
std::string_view name_of(Mode mode);
std::optional<Mode> mode_named(std::string_view name);

}  // namespace osteomill
