// Your own device in real time: a device that moves down by itself mills the built-in tooth for two seconds.

#include <cstdio>
#include <memory>

#include <osteomill/base/real_time.h>
#include <osteomill/live/live_timing.h>
#include <osteomill/session/milling_entry.h>
#include <osteomill/session/milling_session.h>
#include <osteomill/volume/builtin_tooth.h>

// Replace the functions by calls to your hardware.
class OwnDevice : public osteomill::Device {
 public:
  explicit OwnDevice(const osteomill::Pose& above) : X_WD_(above) {}
  osteomill::Pose read_pose() override { return X_WD_; }
  void write_wrench(const osteomill::Wrench& wrench) override { force_N_ = wrench.force_N; }
  bool is_spindle_requested() const noexcept override { return true; }
  // Stops if the bone pushes back.
  void tick_done(const osteomill::Pose&, double dt_s) noexcept override {
    if (force_N_.norm() < 2) X_WD_.position_mm -= 2 * dt_s * shaft_direction(X_WD_);
  }

 private:
  osteomill::Pose X_WD_;
  osteomill::Vec3 force_N_ = osteomill::Vec3::Zero();
};

int main() {
  const auto bone =
      std::make_shared<osteomill::Volume>(osteomill::builtin_tooth(), osteomill::kBuiltinToothIsovalue);
  const osteomill::MillingSetup setup;
  osteomill::MillingSession session(bone, estimate_densities(*bone), setup);
  OwnDevice device(pose_above(place_entry(*bone, setup.tool), setup.tool, 0.5));
  if (const auto refused = osteomill::request_real_time()) std::puts(refused->c_str());
  double time_s = 0;
  osteomill::NextDeadline next{osteomill::monotonic_now_ns(), 1};
  while (time_s < 2) {
    osteomill::wait_until(next.deadline_ns);
    session.tick(device, {.time_s = time_s, .late_s = 1e-3 * (next.periods - 1)});
    next = osteomill::next_deadline(next.deadline_ns, osteomill::monotonic_now_ns(), 1'000'000);
    time_s += 1e-3 * next.periods;
  }
  device.write_wrench({});
  std::printf("%.2f mm^3 removed\n", session.removed_mm3());
  return session.removed_mm3() > 0 ? 0 : 1;
}
