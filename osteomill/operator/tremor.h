#pragma once

#include <array>
#include <cstdint>

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// The tremor of a hand, a displacement or a rotation vector in W, a function of time alone: along each axis
/// a sum of sines of equal size and seeded frequency and phase, nine tenths of the power between 8 and 12 Hz
/// (physiological tremor) and one tenth spread over 1 to 30 Hz. The same seed gives the same signal whatever
/// the tick's rate, and the same bits on every machine (nothing but sums and products is used, no library's
/// sine).
class Tremor {
 public:
  /// `rms` is the root mean square along each axis, in mm or rad. Throws std::invalid_argument where it is
  /// negative or not finite.
  Tremor(std::uint64_t seed, double rms);

  /// Safe in the haptic tick.
  Vec3 at(double time_s) const;

 private:
  static constexpr int kSinesPerBand = 16;
  static constexpr int kSines = 2 * kSinesPerBand;
  struct Sine {
    double amplitude;
    double frequency_hz;
    double phase_turns;
  };
  std::array<std::array<Sine, kSines>, 3> axes_;
};

}  // namespace osteomill
