#pragma once

#include <optional>
#include <vector>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/pose.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/milling/burr_reach.h"
#include "osteomill/milling/chip_law.h"
#include "osteomill/milling/cut_voxels.h"
#include "osteomill/milling/label_tally.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Settings that determine the removal rate kappa. With the defaults a burr of 1.5 mm radius removes 3.4
/// mm^3/(N s). They are plausible for bone but have no published source.
struct CuttingSettings {
  double spindle_speed_rpm = 40000;
  /// Cutting (tangential) force at the burr's rim relative to the normal force.
  double tangential_share = 0.3;
  /// Work per removed volume of bone of the reference density; N mm/mm^3 is MPa.
  double specific_energy_Nmm_per_mm3 = 550;
};

/// Returns kappa in mm^3/(N s): the power of the cutting force at the rim's speed, per newton pressed, over
/// the specific energy. Throws std::invalid_argument if a setting or the radius is not a positive number.
double removal_rate_mm3_per_Ns(const CuttingSettings& cutting, double burr_radius_mm);

/// Settings of BurrMill and CuttingReaction, derived from a MillingSetup by `milling_settings`.
struct MillingSettings {
  /// kappa: bone removed per newton of burr force and second, mm^3 of reference density.
  double removal_rate_mm3_per_Ns =
      osteomill::removal_rate_mm3_per_Ns(CuttingSettings{}, MillingTool{}.burr_radius_mm);
  /// Tangential force relative to the normal force, as rendered by CuttingReaction. If 0, the hand does not
  /// feel it, and the whole burr cuts as efficiently as its rim.
  double reaction_share = 0;
  /// Chip law, used instead of kappa. Its power always takes into account which part of the burr cuts
  /// (`rim_power_fraction`).
  std::optional<ChipLaw> chips = {};
  /// Tangential force at the rim relative to the normal force.
  double tangential_share = CuttingSettings{}.tangential_share;
  /// Set speed of the spindle.
  double spindle_speed_rpm = CuttingSettings{}.spindle_speed_rpm;
};

/// Properties of the bone being cut, estimated while milling.
struct CutBone {
  /// Contact area projected along the pressing direction; 0 if not known yet.
  double area_mm2 = 0;
  /// Mean density in front of the burr relative to the reference, and its coefficient of variation.
  double density = 1;
  double grain = 0;
};

/// The result of one step of milling.
struct MillingStep {
  VolumeChange change;
  /// Removed bone, mm^3 of reference density: each voxel counts by its density above the surroundings. Summed
  /// from the densities as written, so it matches the volume exactly.
  double removed_mm3 = 0;
  /// Removal rate that the force paid for, mm^3 of reference density per second.
  double rate_mm3_s = 0;
};

/// Removes bone within an energy budget: each step may remove kappa * force * dt. The leading half of the
/// ball is shifted from the shown position along the force on the bone until the removal costs just that; the
/// trailing half cuts at the shown position. So bone is removed where the burr presses, most in the middle of
/// the contact, and a wall that it only slides along stays. The ball cuts to a surface (cut_voxels.h): the
/// hole does not depend on the voxel size, and going over it again removes nothing.
///
/// Unspent budget is carried over, up to 10 ms worth of pressing, and dropped after 50 ms without force.
///
/// If the burr overlaps more bone than one step has time for, a step processes only every 2nd, 4th, ... or
/// 64th line of the grid, in turn, and spends the whole budget there. This bounds the time of a step for any
/// burr and voxel size.
///
/// Not the paper's rule, which was published in earlier work; see docs/algorithms.md.
class BurrMill {
 public:
  /// Allocates everything that `step` needs. `volume` must outlive this. From the first step on, its
  /// densities must not rise, because voxels once found empty are not read again. Throws
  /// std::invalid_argument if the radius or the rate is out of range or the reference is not denser than the
  /// surroundings.
  BurrMill(Volume& volume, double burr_radius_mm, const BoneDensities& densities,
           const MillingSettings& settings);

  /// Lowers the volume's densities, never below the surroundings. `burr_centre_W` is the simulated burr's
  /// centre, `burr_force_W_N` the part of its force on the bone that pays for removal (`paying_force_W_N`),
  /// `speed_share` the spindle's actual speed relative to the set speed. Removes nothing if one of them is
  /// not finite. Safe in the haptic tick; the time grows with the number of voxels overlapped.
  MillingStep step(const Vec3& burr_centre_W, const Vec3& burr_force_W_N, double dt_s,
                   double speed_share = 1) noexcept OSTEOMILL_NONBLOCKING;
  /// Returns the estimate of the bone being cut, as of the last tick that cut. Updated only with the chip
  /// law.
  const CutBone& cut_bone() const { return cut_bone_; }
  /// Returns the tally of bone removed per label, from which the caller takes the entries. Empty if the
  /// volume has no labels.
  LabelTally& by_label() { return by_label_; }
  /// Returns the unspent cutting budget, in mm^3 of reference density.
  double unspent_mm3() const { return unspent_mm3_; }

  /// State carried between steps, apart from the bone. (If steps process only part of the lines, they also
  /// depend on which voxels are known to be empty.)
  struct Memory {
    CutBone cut_bone;
    BurrReach::Share share;
    std::size_t pieces_this_round = 0;
    double ahead_mm = 0;
    double unspent_mm3 = 0;
    double force_free_s = 0;
  };
  Memory memory() const {
    return {cut_bone_, share_, pieces_this_round_, ahead_mm_, unspent_mm3_, force_free_s_};
  }
  /// Resumes from the state of another mill on an identical bone. Call before the first step.
  void resume_from(const Memory& memory) {
    cut_bone_ = memory.cut_bone;
    share_ = memory.share;
    pieces_this_round_ = memory.pieces_this_round;
    ahead_mm_ = memory.ahead_mm;
    unspent_mm3_ = memory.unspent_mm3;
    force_free_s_ = memory.force_free_s;
  }

 private:
  double rate_mm3_s(double force_N, double speed_share) const;
  void step_without_force(double dt_s);
  void sample_ahead(const Vec3& centre_W, const Vec3& ahead_W, double dt_s);
  void measure_contact(double slope_per_mm, double dt_s);
  void update_line_share(std::size_t found, double advance_voxels);
  CuttingBall ball_in_grid(const Vec3& centre_W, const Vec3& force_W_N) const;
  void find(const CuttingBall& ball, double max_ahead_mm, double pressed_mm3);
  MillingStep lower_found(double dropped);
  void count_labels(const LabelMap& labels, const CutVoxels::Row& row);

  const GridGeometry& geometry() const { return volume_->geometry(); }

  Volume* volume_;
  double radius_mm_;
  BoneDensities densities_;
  double mm3_per_density_;
  MillingSettings settings_;
  CutBone cut_bone_;
  std::vector<Vec3> directions_;  // sampled by sample_ahead; empty without the chip law
  double min_ahead_mm_;
  double max_ahead_mm_;
  BurrReach reach_;
  CutVoxels voxels_;
  LabelTally by_label_;
  BurrReach::Share share_;
  std::size_t pieces_this_round_ = 0;  // pieces found since the current round over all lines began
  double ahead_mm_ = 0;
  double unspent_mm3_ = 0;
  double force_free_s_ = 0;
};

}  // namespace osteomill
