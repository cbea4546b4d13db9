#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace osteomill {

/// The three algorithms of Eriksson 2012, in the paper's order.
enum class AlgorithmId : unsigned char { line_proxy, surface_points, point_shell };

inline constexpr std::array<AlgorithmId, 3> kAllAlgorithms{
    AlgorithmId::line_proxy, AlgorithmId::surface_points, AlgorithmId::point_shell};

/// As written on the command line and in files: "line-proxy", "surface-points", "point-shell".
std::string_view name_of(AlgorithmId algorithm);
std::optional<AlgorithmId> algorithm_named(std::string_view name);

/// `paper` is what the paper says; `steady` the same algorithm with named improvements.
enum class Mode : unsigned char { paper, steady };

std::string_view name_of(Mode mode);
std::optional<Mode> mode_named(std::string_view name);

}  // namespace osteomill
