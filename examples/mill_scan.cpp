// From a scan to a force: a burr moves straight down into the bone for three seconds of simulated time. No
// person holds the device, so the wrench guard only limits the force.
//
//     ./mill_scan [SCAN [ISOVALUE]]

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <utility>

#include <osteomill/ct/read_scan.h>
#include <osteomill/session/milling_entry.h>
#include <osteomill/session/milling_session.h>
#include <osteomill/session/trajectory.h>
#include <osteomill/volume/bone_densities.h>
#include <osteomill/volume/builtin_tooth.h>
#include <osteomill/volume/isovalue.h>

int main(int argc, char** argv) try {
  osteomill::Scan scan = argc > 1 ? osteomill::read_scan(argv[1])
                                  : osteomill::Scan{osteomill::builtin_tooth(), "built-in tooth", "made up"};
  const double isovalue =
      argc > 2 ? std::atof(argv[2]) : osteomill::suggest_isovalue(scan.grid, scan.in_hounsfield_units).value;
  const auto bone = std::make_shared<osteomill::Volume>(std::move(scan.grid), isovalue);

  osteomill::MillingSetup setup;
  setup.tool.burr_radius_mm = 1;
  setup.guard = osteomill::GuardSettings::for_simulation({.force_N = 3});
  // Finds a point to drill into and the direction; slow, so not in each tick.
  const osteomill::MillingEntry entry = place_entry(*bone, setup.tool);
  osteomill::MillingSession session(bone, estimate_densities(*bone), setup);

  osteomill::PosedDevice device;
  for (int n = 0; n < 3000; ++n) {
    device.put(pose_above(entry, setup.tool, 0.5 - 0.001 * n));
    const osteomill::TickRecord now = session.tick(device, {.time_s = 1e-3 * n, .spindle_on = true});
    if (n % 500 != 499) continue;
    std::printf("%.1f s: %5.2f N, %5.2f N mm, %5.2f mm^3 removed%s%s\n", 1e-3 * (n + 1),
                now.wrench.force_N.norm(), now.wrench.torque_Nmm.norm(), now.removed_mm3,
                now.fault == osteomill::WrenchFault::none ? "" : ", ",
                now.fault == osteomill::WrenchFault::none ? "" : name_of(now.fault).data());
  }
  return session.removed_mm3() > 0 ? 0 : 1;
} catch (const std::exception& error) {  // an InputError names the file
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
