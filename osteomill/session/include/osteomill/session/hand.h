#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// A hand that holds the handle: a spring and damper towards a target pose, with a limited spring force. Each
/// rotational value is the translational one times the square of one lever arm (31.6 mm, 1e-3 m^2), which is
/// also the ratio of the handle's inertia to its mass, so both motions have the same frequency and damping
/// ratio.
struct HandSettings {
  /// 500 N/m.
  double stiffness_N_per_mm = 0.5;
  /// 5 N s/m.
  double damping_Ns_per_mm = 0.005;
  /// 0.5 N m/rad.
  double torsional_stiffness_Nmm_per_rad = 500.0;
  /// 0.005 N m s/rad: the same damping ratio as in translation (0.2 with the default handle).
  double torsional_damping_Nmms_per_rad = 5.0;
  /// Maximum force of the spring. The damper is not limited.
  double push_N = 1.5;
  /// Lever arm of the torque limit: the torsional spring gives at most push_N times this.
  double push_lever_mm = 10.0;
  /// Rms tremor along each axis. Measured: 0.038 mm in all, for instruments held still over an eye (Singh and
  /// Riviere 2002).
  double tremor_mm = 0.02;
  /// Rms rotation of the tremor about each axis. Measured on outstretched hands: 0.01 g at 7 Hz (the most
  /// frequent value of 97; range 0.0015 to 0.035 g; Wade, Gresty and Findley 1982), i.e. 0.036 mm, some 80 mm
  /// from the rotating wrist.
  double tremor_rad = 0.0005;
};

/// Throws std::invalid_argument, naming the setting, if one is negative or not finite.
void require_valid(const HandSettings& settings);

/// Returns the maximum torque of the torsional spring.
inline double torque_limit_Nmm(const HandSettings& settings) noexcept {
  return settings.push_N * settings.push_lever_mm;
}

/// Returns the wrench of the hand on the handle, in W about the burr's centre: springs towards the target,
/// clamped to their limits, and dampers on the motion relative to the target. Safe in the haptic tick.
Wrench hand_wrench(const HandSettings& hand, const Pose& X_W_target, const Twist& target_velocity,
                   const Pose& X_WD, const Twist& velocity) noexcept;

/// Returns a random hand within the range of real ones, for studies over many hands: stiffness uniform in 135
/// to 1000 N/m, damping in 5 to 10 N s/m, rotation by the lever arm of HandSettings. The softest corresponds
/// to an arm that holds a haptic device lightly (135 N/m, 6.45 N s/m, 0.554 kg; van Beek et al. 2015,
/// Scientific Reports 5:18004); firm grips reach about 1000 N/m. Push and tremor stay at their defaults. The
/// same seed gives the same hand.
HandSettings random_hand(std::uint64_t seed);

/// Returns a hand with a `firmness` times firmer grip: scales all stiffness and damping by `firmness`,
/// because both increase with grip force (Hasser and Cutkosky 2002, nine hands on a knob; stiffness
/// proportionally: Hoeppner, McIntyre and van der Smagt 2013).
HandSettings with_firmer_grip(HandSettings hand, double firmness);

/// Hand tremor as a displacement or rotation vector in W, a function of time only. Along each axis a sum of
/// sines with seeded frequencies and phases: 90 % of the power between 8 and 12 Hz (physiological tremor),
/// the rest over 1 to 30 Hz; equal amplitudes within each band. The same seed gives the same signal at any
/// tick rate, bit-identical on every machine (only sums and products, no library sine).
class Tremor {
 public:
  /// `rms` applies to each axis, in mm or rad. Throws std::invalid_argument if it is negative or not finite.
  Tremor(std::uint64_t seed, double rms);

  /// Returns the displacement, mm, or the rotation vector, rad, at `time_s`. Safe in the haptic tick.
  Vec3 at(double time_s) const noexcept;

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

/// Random numbers that are bit-identical with every compiler and library, for random_hand() and Tremor. The
/// standard defines the engine exactly but not std::uniform_real_distribution, which is therefore not used.
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : engine_(seed) {}

  /// Returns the next number, uniform in [min, max), in steps of 2^-53 of the range.
  double uniform(double min, double max) {
    return min + (max - min) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace osteomill
