#pragma once

#include <cstdint>
#include <random>

namespace osteomill {

/// Random numbers that are the same bits with every compiler and library: the engine is fixed by the
/// standard, the mapping to a range is our own (std::uniform_real_distribution is left to the library).
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [least, greatest), in steps of 2^-53 of the range.
  double uniform(double min, double max) {
    return min + (max - min) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace osteomill
