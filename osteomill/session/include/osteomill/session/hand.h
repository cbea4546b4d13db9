#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// A hand that holds the handle: a spring and a damper towards a target pose, with a limit to how hard it
/// pushes. About rotation everything is the translational value times the square of one lever (31.6 mm, 1e-3
/// m^2), which is also the handle's inertia over its mass: both motions then have the same frequency and
/// damping ratio.
struct HandSettings {
  /// 500 N/m.
  double stiffness_N_per_mm = 0.5;
  /// 5 N s/m.
  double damping_Ns_per_mm = 0.005;
  /// 0.5 N m/rad.
  double torsional_stiffness_Nmm_per_rad = 500.0;
  /// 0.005 N m s/rad: the same damping ratio as along a line (0.2 with the default handle).
  double torsional_damping_Nmms_per_rad = 5.0;
  /// The most that the spring gives, whatever its stretch. The damper is not limited.
  double push_N = 1.5;
  /// The torsional spring gives at most push_N at this lever.
  double push_lever_mm = 10.0;
  /// Root mean square of the tremor along each axis: instruments held still over an eye were measured with
  /// 0.038 mm in all (Singh and Riviere 2002).
  double tremor_mm = 0.02;
  /// The tremor's rotation about each axis, rms. Hands held out were measured with 0.01 g at 7 Hz (the
  /// commonest of 97; 0.0015 to 0.035 g; Wade, Gresty and Findley 1982): 0.036 mm, some 80 mm from the wrist
  /// that turns.
  double tremor_rad = 0.0005;
};

/// Throws std::invalid_argument, naming the setting, if one is negative or not finite.
void require_valid(const HandSettings& settings);

/// Returns the most that the torsional spring gives.
inline double torque_limit_Nmm(const HandSettings& settings) noexcept {
  return settings.push_N * settings.push_lever_mm;
}

/// Returns the wrench of the hand on the handle, in W about the burr's centre: springs towards the target,
/// each no stronger than its limit, and dampers against the motion relative to the target. Safe in the haptic
/// tick.
Wrench hand_wrench(const HandSettings& hand, const Pose& X_W_target, const Twist& target_velocity,
                   const Pose& X_WD, const Twist& velocity) noexcept;

/// Returns a hand drawn from the range of real ones, for studies over many: stiffness uniform from 135 to
/// 1000 N/m, damping from 5 to 10 N s/m, rotation by the same lever as above. The softest is an arm that
/// holds a haptic device lightly (135 N/m, 6.45 N s/m, 0.554 kg; van Beek et al. 2015, Scientific Reports
/// 5:18004); firm grips reach about 1000 N/m. Push and tremor stay at their defaults. The same seed gives the
/// same hand.
HandSettings random_hand(std::uint64_t seed);

/// Returns a hand that grips `firmness` times as firmly: all its stiffness and damping times `firmness`,
/// since both rise steadily with the force of the grip (Hasser and Cutkosky 2002, nine hands on a knob;
/// stiffness in proportion: Hoeppner, McIntyre and van der Smagt 2013).
HandSettings gripping(HandSettings hand, double firmness);

/// The tremor of a hand, a displacement or a rotation vector in W, a function of time alone: along each axis
/// a sum of sines of equal size and seeded frequency and phase, nine tenths of the power between 8 and 12 Hz
/// (physiological tremor) and one tenth spread over 1 to 30 Hz. The same seed gives the same signal whatever
/// the tick's rate, and the same bits on every machine (nothing but sums and products is used, no library's
/// sine).
class Tremor {
 public:
  /// `rms` is the root mean square along each axis, in mm or rad. Throws std::invalid_argument if it is
  /// negative or not finite.
  Tremor(std::uint64_t seed, double rms);

  /// Returns the displacement in mm, or the rotation vector in rad, at a time. Safe in the haptic tick.
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

/// Draws random numbers that are the same bits with every compiler and library, as of a hand (random_hand())
/// or its Tremor: the engine is fixed by the standard, the mapping to a range is our own
/// (std::uniform_real_distribution is left to the library).
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
