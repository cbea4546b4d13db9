#pragma once

#include <cstddef>
#include <span>

namespace osteomill {

/// Warning beat for a nearby structure: rate and pitch. Silent at a rate of 0.
struct BeatState {
  double beats_per_s = 0;
  double pitch_hz = 660;
};

/// Returns the beat for a burr at this distance from a structure: none at `warn_mm` or more, once a second
/// just below it, faster as the burr approaches, a continuous tone on contact. Each structure has its own
/// pitch. Silent if the distance is NaN.
BeatState distance_beat(double distance_mm, double warn_mm, std::size_t structure);

/// Synthesizes a beat. Deterministic. For one thread.
class DistanceBeat {
 public:
  explicit DistanceBeat(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  /// Mixes the next samples into `samples`. Beats begin and end without a click.
  void add_to(const BeatState& state, std::span<float> samples);

 private:
  double sample_rate_hz_;
  double phase_turns_ = 0;
  double beat_phase_ = 0;
  double loudness_ = 0;
};

}  // namespace osteomill
