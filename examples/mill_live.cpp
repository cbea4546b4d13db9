// Live milling with the library alone: a simulated hand mills the built-in tooth in real time with one
// algorithm after the other while the surface is updated; then undoes the last cut.

#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>
#include <vector>

#include <osteomill/live/live_milling.h>
#include <osteomill/session/milling_entry.h>
#include <osteomill/session/virtual_hand.h>
#include <osteomill/volume/builtin_tooth.h>

namespace {

// Returns the number of triangles that a window would draw.
std::size_t count_triangles(osteomill::LiveMilling& milling, std::vector<std::size_t>& by_brick) {
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  for (const auto& [brick, levels] : milling.take_changed_bricks()) {
    by_brick[brick] = levels.levels[0].count / 3;
  }
  std::size_t count = 0;
  for (const std::size_t triangles : by_brick) count += triangles;
  return count;
}

}  // namespace

int main() {
  const auto bone =
      std::make_shared<osteomill::Volume>(osteomill::builtin_tooth(), osteomill::kBuiltinToothIsovalue);
  osteomill::MillingSetup setup;
  const osteomill::MillingEntry entry = place_entry(*bone, setup.tool);
  osteomill::VirtualHand hand({}, osteomill::pointing_hand(), pose_above(entry, setup.tool, 0.5));
  osteomill::LiveMilling milling(bone, setup, hand);
  std::vector<std::size_t> by_brick(milling.follower().layout().count());
  milling.start();
  hand.pull_to(pose_above(entry, setup.tool, -2.0));
  for (const char* name : {"point-shell", "surface-points"}) {
    setup.algorithm = osteomill::algorithm_named(name);
    if (!milling.change(setup)) return 1;
    milling.finish_preparing();
    milling.set_spindle(true);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    milling.set_spindle(false);
    std::printf("%-14s %.2f mm^3 removed, %zu triangles\n", name, milling.state().record.removed_mm3,
                count_triangles(milling, by_brick));
  }
  const double removed_mm3 = milling.state().record.removed_mm3;
  if (!milling.undo()) return 1;
  milling.finish_preparing();
  std::printf("one cut undone %.2f mm^3 removed, %zu triangles\n", milling.state().record.removed_mm3,
              count_triangles(milling, by_brick));
  return milling.state().record.removed_mm3 < removed_mm3 ? 0 : 1;
}
