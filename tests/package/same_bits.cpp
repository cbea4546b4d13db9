// A user's program that mills with every algorithm and also calls inline functions of the headers, and prints
// the bits, which must not depend on the user's flags.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>

#include <osteomill/haptics/algorithms.h>
#include <osteomill/session/milling_session.h>
#include <osteomill/session/trajectory.h>
#include <osteomill/volume/builtin_tooth.h>
#include <osteomill/volume/sampling.h>

namespace {

void add(std::uint64_t& hash, const osteomill::Vec3& vector) {
  for (const double number : vector) hash = (hash ^ std::bit_cast<std::uint64_t>(number)) * 0x100000001b3;
}

}  // namespace

int main() {
  using namespace osteomill;
  const Volume scan(builtin_tooth(), kBuiltinToothIsovalue);
  const Vec3 middle_W = scan.geometry().world_from_voxel(
      VoxelIndex{scan.geometry().dims[0] / 2, scan.geometry().dims[1] / 2, scan.geometry().dims[2] - 1});
  const Vec3 top_W = first_crossing(scan, middle_W, middle_W - Vec3(0, 0, 100)).value_or(middle_W);
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    MillingSession session(std::make_shared<Volume>(scan), estimate_densities(scan),
                           {.algorithm = algorithm});
    PosedDevice device;
    std::uint64_t hash = 0;
    for (int n = 0; n < 600; ++n) {
      const Pose lean{Vec3(0, 0, -1.37), quaternion_from_rotation_vector({3e-4 * n, 1e-4 * n, 0})};
      device.put(Pose{top_W + Vec3(0.001 * n, 0, 5.1 - 0.008 * n), Quat::Identity()} * lean.inverse() * lean *
                 lean);
      const TickRecord record = session.tick(device, {.time_s = 1e-3 * n, .spindle_on = n > 100});
      add(hash, record.X_WD.position_mm);
      add(hash, record.X_WT * Vec3(0.1, 0.2, 0.3));
      add(hash, record.wrench.force_N);
      add(hash, record.wrench.torque_Nmm);
    }
    std::printf("%s %016llx %a mm^3\n", algorithm.id.name.c_str(), static_cast<unsigned long long>(hash),
                session.removed_mm3());
    if (!(session.removed_mm3() > 0)) return 1;
  }
  return 0;
}
