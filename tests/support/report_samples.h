#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recording.h"

namespace osteomill::testing_support {

/// Returns the bytes of a small PNG: a ball of bone, with a hole if `milled`.
std::vector<unsigned char> sample_png(bool milled, int width = 320, int height = 240);

/// Returns a synthetic recording that shows the paper's findings: 1 has torque kicks, 2 buzzes, 3 is calm.
inline Recording sample_run(std::string_view algorithm, std::string_view phase, int ticks = 20000) {
  using std::sin;
  constexpr double kTwoPi = 2 * std::numbers::pi;
  const int a = algorithm == "line-proxy" ? 0 : algorithm == "surface-points" ? 1 : 2;
  const bool milling = phase == "milling";
  Recording recording;
  recording.path = std::string(algorithm) + "-" + std::string(phase) + ".h5";
  RunDescription& d = recording.description;
  d.program_version = "0.1.0";
  d.scan_name = "built-in tooth";
  d.dims = {256, 256, 176};
  d.spacing_mm = {0.1, 0.1, 0.1};
  d.isovalue = 1200;
  d.algorithm = algorithm_named(algorithm).id;
  d.phase = phase;
  d.seed = 1;
  d.settings = {{"algorithm.stiffness", a == 1 ? 20.0 : 2.0, "N/mm"},
                {"push", 1.5, "N"},
                {"hand_stiffness", 500.0, "N/m"},
                {"removal_rate", 2.0, "mm^3/(N s)"},
                {"command_line", std::string("osteomill compare --out <folder> --seed 1"), ""}};
  const double buzz_N[] = {0.02, 0.12, 0.012};
  const double buzz_Nmm[] = {0.9, 0.5, milling ? 0.35 : 0.08};
  const double wobble_deg[] = {0.9, 0.6, 0.25};
  const double step_us[] = {6, 4, 24};
  std::uint64_t state = 88172645463325252u + static_cast<std::uint64_t>(10 * a + (milling ? 1 : 0));
  const auto noise = [&] {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return static_cast<double>(state >> 11) / 4503599627370496.0 - 1.0;
  };
  for (int n = 0; n < ticks; ++n) {
    const double t = 0.001 * n;
    TickRecord r;
    r.time_s = t;
    const double load = milling
                            ? 1.6 * (1 - std::exp(-0.8 * std::max(0.0, t - 1))) + 0.2 * sin(0.9 * t) * (t > 1)
                            : 1.4 + 0.1 * sin(0.5 * t);
    const double contact = load > 0.05 ? 1 : 0;
    r.wrench.force_N = {0.1 * load, contact * buzz_N[a] * noise() * 1.7,
                        load + contact * buzz_N[a] * noise()};
    r.wrench.torque_Nmm = contact * Vec3(6 * load * (0.6 + 0.4 * sin(0.3 * t)) + buzz_Nmm[a] * noise(),
                                         2 + buzz_Nmm[a] * sin(kTwoPi * 60 * t), 0.1 * noise());
    const bool kick = a == 0 && milling && n > 12000 && n < 12030;
    if (kick) r.wrench.torque_Nmm *= 4.0;
    const double degrees = std::numbers::pi / 180;
    const double drift = milling ? 4 * degrees * sin(kTwoPi * t / 20) : 0.0;
    const Vec3 turn(drift + wobble_deg[a] * degrees * (0.5 * sin(2 * t) + 0.3 * noise()),
                    wobble_deg[a] * degrees * (0.5 * sin(2.7 * t + 1) + 0.3 * noise()) + 0.3, 0);
    r.X_WT = {{12 + 0.1 * sin(t), 12, 20 - 0.2 * t}, quaternion_from_rotation_vector(turn)};
    r.X_WD = r.X_WT;
    r.contacts = static_cast<int>(20 * load);
    r.burr_force_W_N.z() = -load;
    r.removed_mm3 = milling ? 2.0 * std::max(0.0, t - 1.5) : 37.0;
    r.compute_us =
        step_us[a] * (1 + 0.2 * noise()) + (n % 3777 == 17 ? 300.0 : 0.0) + (n == 9000 ? 1080.0 : 0.0);
    r.milling_us = milling ? 8 + 2 * noise() : 0.0;
    recording.records.push_back(r);
  }
  if (milling) recording.pictures = {{"after", sample_png(true)}, {"before", sample_png(false)}};
  return recording;
}

/// Returns a page without XML namespace names, which look like links.
inline std::string without_namespaces(std::string page) {
  constexpr std::string_view kNamespace = "http://www.w3.org/";
  for (auto at = page.find(kNamespace); at != std::string::npos; at = page.find(kNamespace, at))
    page.erase(at, kNamespace.size());
  return page;
}

/// Returns runs of three algorithms with two phases each.
inline std::vector<Recording> sample_runs(int ticks = 20000) {
  std::vector<Recording> runs;
  for (const char* algorithm : {"line-proxy", "surface-points", "point-shell"}) {
    for (const char* phase : {"milling", "holding"}) runs.push_back(sample_run(algorithm, phase, ticks));
  }
  return runs;
}

}  // namespace osteomill::testing_support
