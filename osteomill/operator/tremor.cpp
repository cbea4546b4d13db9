#include "osteomill/operator/tremor.h"

#include <cmath>
#include <stdexcept>

#include "osteomill/numbers/positive.h"
#include "osteomill/operator/seeded_random.h"

namespace osteomill {

namespace {

struct Band {
  double lowest_hz;
  double highest_hz;
  double share_of_power;
};

constexpr Band kPhysiological{8.0, 12.0, 0.9};
constexpr Band kBroad{1.0, 30.0, 0.1};

// sin(2 pi turns) to 1e-9 by its series: library sines differ in the last bit from one machine to the next.
double sine_of_turns(double turns) {
  double folded = turns - std::floor(turns + 0.5);
  if (folded > 0.25) folded = 0.5 - folded;
  if (folded < -0.25) folded = -0.5 - folded;
  const double angle = 6.283185307179586 * folded;
  const double square = angle * angle;
  double sum = 0;
  for (int n = 15; n >= 3; n -= 2) sum = (1.0 + sum) * (-square / static_cast<double>(n * (n - 1)));
  return angle * (1.0 + sum);
}

}  // namespace

Tremor::Tremor(std::uint64_t seed, double rms) {
  require_not_negative(rms, "tremor: its root mean square");
  SeededRandom random(seed);
  for (auto& sines : axes_) {
    std::size_t next = 0;
    for (const Band& band : {kPhysiological, kBroad}) {
      // One sine in each equal part of the band, somewhere in it: no two periods fit, so that nothing
      // repeats.
      const double part_hz = (band.highest_hz - band.lowest_hz) / kSinesPerBand;
      const double amplitude = rms * std::sqrt(2.0 * band.share_of_power / kSinesPerBand);
      for (int n = 0; n < kSinesPerBand; ++n) {
        const double lowest_hz = band.lowest_hz + part_hz * n;
        const double frequency_hz = random.uniform(lowest_hz, lowest_hz + part_hz);
        const double phase_turns = random.uniform(0.0, 1.0);
        sines[next++] = {amplitude, frequency_hz, phase_turns};
      }
    }
  }
}

Vec3 Tremor::at(double time_s) const {
  Vec3 displacement = Vec3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double sum = 0;
    for (const Sine& sine : axes_[axis]) {
      sum += sine.amplitude * sine_of_turns(sine.frequency_hz * time_s + sine.phase_turns);
    }
    displacement[static_cast<Eigen::Index>(axis)] = sum;
  }
  return displacement;
}

}  // namespace osteomill
