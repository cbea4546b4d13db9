#pragma once

#include <string>
#include <vector>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/study.h"

namespace osteomill::testing_support {

// Hand-made values; the tests check how they are evaluated.
struct Values {
  double force_hp = 0;
  double torque_hp = 0;
};

inline MeasuredRun row(std::uint64_t seed, std::string_view algorithm, std::string_view phase,
                       const Values& values) {
  MeasuredRun row{
      .algorithm = algorithm_named(algorithm).id, .phase = std::string(phase), .metrics = {}, .seed = seed};
  row.hand_stiffness_N_per_m = 100 * static_cast<double>(seed);
  row.hand_damping_Ns_per_m = 5;
  row.metrics.rate_hz = 1000;
  row.metrics.contact = {1, 1, 1, 1, 1};
  row.metrics.force_N.mean = 2;
  row.metrics.force_N.hp_rms = values.force_hp;
  row.metrics.force_N.hp_share = values.force_hp / 2;
  row.metrics.torque_Nmm.mean = 10;
  row.metrics.turns = {0.5, 0.1};
  row.metrics.torque_follows_force = 0.7;
  row.metrics.contacts_mean = 15;
  row.metrics.torque_Nmm.hp_rms = values.torque_hp;
  row.metrics.torque_Nmm.hp_share = values.torque_hp / 10;
  return row;
}

// Rows for seeds from 1: algorithm 2 buzzes 10 x `buzz` times as much as 1 and 3, which swap ranks from seed
// to seed.
inline std::vector<MeasuredRun> sample_rows(std::uint64_t seeds, double buzz = 1) {
  std::vector<MeasuredRun> rows;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const double hand = 1 + 0.01 * static_cast<double>(seed);
    const double turn = seed % 2 == 0 ? 0.01 : -0.01;
    for (const std::string_view phase : {kHolding, kMilling}) {
      rows.push_back(row(seed, "point-shell", phase, {0.1 * hand - turn * hand, 1}));
      rows.push_back(row(seed, "line-proxy", phase, {0.1 * hand + turn * hand, 3}));
      rows.push_back(row(seed, "surface-points", phase, {buzz * hand, 2}));
    }
  }
  return rows;
}

}  // namespace osteomill::testing_support
