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

/// The settings from which the removal rate kappa follows. The defaults make a burr of 1.5 mm radius remove
/// 3.4 mm^3/(N s); they are plausible for bone, and no source is claimed for them.
struct CuttingSettings {
  double spindle_speed_rpm = 40000;
  /// The cutting (tangential) force at the burr's rim, as a share of the force with which it is pressed on.
  double tangential_share = 0.3;
  /// The work that removes a volume of bone of the reference density; N mm / mm^3 is MPa.
  double specific_energy_Nmm_per_mm3 = 550;
};

/// Returns kappa in mm^3/(N s): the power of the cutting force at the rim's speed, per newton pressed, over
/// the specific energy. Throws std::invalid_argument if a setting or the radius is not a positive number.
double removal_rate_mm3_per_Ns(const CuttingSettings& cutting, double burr_radius_mm);

/// The settings by which a BurrMill mills and the hand feels it (`milling_settings` of a MillingSetup).
struct MillingSettings {
  /// kappa: the bone removed per newton of burr force and second, in mm^3 of reference density.
  double removal_rate_mm3_per_Ns =
      osteomill::removal_rate_mm3_per_Ns(CuttingSettings{}, MillingTool{}.burr_radius_mm);
  /// The cutting force along the burr's speed as a share of its force, if the hand is to feel it
  /// (CuttingReaction); 0 if not, and all of the burr then cuts as its rim does.
  double reaction_share = 0;
  /// The law by which chips are cut, instead of kappa. Its power always counts the place where the burr cuts.
  std::optional<ChipLaw> chips = {};
  /// The force along the rim's speed as a share of the force that presses.
  double tangential_share = CuttingSettings{}.tangential_share;
  /// The speed that the spindle is set to.
  double spindle_speed_rpm = CuttingSettings{}.spindle_speed_rpm;
};

/// The bone that the burr is cutting, measured while it cuts.
struct CutBone {
  /// The contact's area across the push; 0 if not known yet.
  double area_mm2 = 0;
  /// The mean density before the burr, relative to the reference, and its coefficient of variation there.
  double density = 1;
  double grain = 0;
};

/// The result of one step of milling.
struct MillingStep {
  VolumeChange change;
  /// The bone taken, in mm^3 of reference density, each voxel charged by its density above the surroundings.
  /// Summed from the densities as they were written, so that it is exact for the volume as it now stands.
  double removed_mm3 = 0;
  /// The rate that was paid for, in mm^3 of reference density a second.
  double rate_mm3_s = 0;
};

/// Removes the bone that the burr sweeps, by energy: each step may take kappa * force * dt. The burr's ball
/// goes ahead of where it is shown, along its force on the bone, until what it would carve costs just that;
/// behind its centre it carves where it is shown. So bone goes where the burr presses, most in the middle of
/// the contact, and a wall that it only slides past stays. What is carved is a surface (cut_voxels.h): the
/// same hole in any voxels, and nothing more where the burr has been before.
///
/// A budget that could not be spent is carried over, but no more than that of 10 ms of pressing, and is
/// forgotten after 50 ms without force.
///
/// If the burr meets more bone than a step has time for, it looks at every second line of the grid, or at
/// every fourth, ... sixty-fourth, in turn, and spends all of its budget there. So a step's time is bounded,
/// whatever the burr and the voxels.
///
/// This rule is not in the paper, whose own is in earlier work; see docs/algorithms.md.
class BurrMill {
 public:
  /// Allocates all that `step` needs for this bone and burr. `volume` outlives it; from the first step on its
  /// densities must not rise, because from step to step only voxels new in reach are searched for bone.
  /// Throws std::invalid_argument if the radius or the rate is out of range or the reference is not denser
  /// than the surroundings.
  BurrMill(Volume& volume, double burr_radius_mm, const BoneDensities& densities,
           const MillingSettings& settings);

  /// Lowers the volume's densities, never below the surroundings. `burr_centre_W` is the simulated burr's
  /// centre, `burr_force_W_N` the part of its force on the bone that pays (`paying_force_W_N`), `speed_share`
  /// the spindle's true speed as a share of the set one; takes nothing if one of them is not finite. Safe in
  /// the haptic tick; time grows with the voxels overlapped.
  MillingStep step(const Vec3& burr_centre_W, const Vec3& burr_force_W_N, double dt_s,
                   double speed_share = 1) noexcept OSTEOMILL_NONBLOCKING;
  /// Returns the bone that is cut with the law of chips, as of the last tick that cut any.
  const CutBone& cut_bone() const { return cut_bone_; }
  /// Returns what the steps took of each label and no caller has taken out of the tally yet. Empty if the
  /// volume has no labels.
  LabelTally& by_label() { return by_label_; }
  /// Returns the unspent cutting budget, in mm^3 of reference density.
  double carry_mm3() const { return carry_mm3_; }

  /// The state that a mill carries from step to step beside the bone. (The steps of a burr that meets more
  /// than they have time for also depend on the voxels that it has seen.)
  struct Memory {
    CutBone cut_bone;
    BurrReach::Share share;
    std::size_t found_of_round = 0;
    double ahead_mm = 0;
    double carry_mm3 = 0;
    double force_free_s = 0;
  };
  Memory memory() const { return {cut_bone_, share_, found_of_round_, ahead_mm_, carry_mm3_, force_free_s_}; }
  /// Goes on where another mill was on such a bone. Call before the first step.
  void resume_from(const Memory& memory) {
    cut_bone_ = memory.cut_bone;
    share_ = memory.share;
    found_of_round_ = memory.found_of_round;
    ahead_mm_ = memory.ahead_mm;
    carry_mm3_ = memory.carry_mm3;
    force_free_s_ = memory.force_free_s;
  }

 private:
  double rate_mm3_s(double force_N, double speed_share) const;
  void lift(double dt_s);
  void look_ahead(const Vec3& centre_W, const Vec3& ahead_W, double dt_s);
  void measure_contact(double slope_per_mm, double dt_s);
  void share_after(std::size_t found, double advance_voxels);
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
  std::vector<Vec3> directions_;  // in which look_ahead looks; none without the law of chips
  double min_ahead_mm_;
  double max_ahead_mm_;
  BurrReach reach_;
  CutVoxels voxels_;
  LabelTally by_label_;
  BurrReach::Share share_;
  std::size_t found_of_round_ = 0;  // since all lines had their turn
  double ahead_mm_ = 0;
  double carry_mm3_ = 0;
  double force_free_s_ = 0;
};

}  // namespace osteomill
