#pragma once

#include <cstddef>
#include <span>

namespace osteomill {

/// The beat that warns of a structure: how often, and how high it sounds. Without beats it is silent.
struct BeatState {
  double beats_per_s = 0;
  double pitch_hz = 660;
};

/// Returns the beat for a burr this far from a structure: none from `warn_mm` on, once a second just below
/// it, faster the nearer the burr comes, and without a break when it touches. Each structure has a pitch of
/// its own. Silent if the distance is not a number.
BeatState distance_beat(double distance_mm, double warn_mm, std::size_t structure);

/// Computes the samples of a beat. The same states give the same samples. For one thread.
class DistanceBeat {
 public:
  explicit DistanceBeat(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  /// Adds the next samples to those that are there. Beats begin and end without a click.
  void add_to(const BeatState& state, std::span<float> samples);

 private:
  double sample_rate_hz_;
  double turns_ = 0;
  double beat_ = 0;
  double loudness_ = 0;
};

}  // namespace osteomill
