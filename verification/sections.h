#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "osteomill/volume/volume.h"

#include "verification/section.h"

// The tables of docs/verification.md, a function for each. Except for compute times they are the same on any
// machine.
namespace osteomill::verification {

/// Bones used by the sections.
struct Bones {
  Volume tooth;
  std::string tooth_name;
  /// Second scan, not used to choose settings.
  std::optional<Volume> second;
  std::string second_name;
  /// Micro-CT of spongy bone; none skips its section.
  std::optional<Volume> spongy;
  std::string spongy_name;
};

/// Amount of work; the defaults are those of the full run.
struct Effort {
  int pushes = 10000;
  int seeds = 5;
  double phase_s = 20;
  double soak_min = 60;
};

Section force_on_planes();
/// Compares the chip law and the spindles with published measurements.
Section force_against_feed();
Section shaft_levers();
Section slide_round_a_ball();
Section turned_scans();
Section drops();
Section energy_given_back();
Section passivity();
Section thin_bone();
Section spongy_bone(const Bones& bones);
Section tools_and_pushes(const Bones& bones, const Effort& effort);
Section breaking_through(const Effort& effort);
/// Measures the paper's findings with the algorithms as published.
Section papers_findings(const Bones& bones, const Effort& effort);
/// Measures the findings with one of the paper's open choices, the hand or the device changed.
Section papers_choices(const Bones& bones, const Effort& effort);
Section energy_of_barrier_shell(const Bones& bones, const Effort& effort);
Section rig_noise(const Bones& bones, const Effort& effort);
Section voxel_sizes(const Effort& effort);
Section fine_scans(const Effort& effort);
Section time_of_a_tick(const Effort& effort);
Section swept_holes(const Effort& effort);
Section haptic_rates(const Bones& bones, const Effort& effort);
Section random_pushes(const Bones& bones, const Effort& effort);
Section milling_the_tooth(const Bones& bones, const Effort& effort);
Section milling_with_cutting_reaction(const Bones& bones, const Effort& effort);
/// Measures the torque's amplitude at half the haptic rate.
Section half_rate_oscillation(const Bones& bones, const Effort& effort);
Section milling_the_second_scan(const Bones& bones, const Effort& effort);
Section soak(const Bones& bones, const Effort& effort);

}  // namespace osteomill::verification
