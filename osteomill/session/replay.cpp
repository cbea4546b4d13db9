#include "osteomill/session/replay.h"

#include "osteomill/device/device.h"

namespace osteomill {

namespace {

constexpr double kLoneTick_s = 1e-3;

double tick_length_s(const std::vector<TrajectoryPoint>& trajectory, std::size_t n) {
  if (trajectory.size() < 2) return kLoneTick_s;
  const std::size_t end = n == 0 ? 1 : n;
  return trajectory[end].time_s - trajectory[end - 1].time_s;
}

}  // namespace

void replay(MillingSession& session, const std::vector<TrajectoryPoint>& trajectory,
            const std::function<void(const TickRecord&)>& record) {
  PosedDevice device;
  for (std::size_t n = 0; n < trajectory.size(); ++n) {
    const TrajectoryPoint& point = trajectory[n];
    device.put(point.X_WD);
    record(session.tick(device, point.time_s, tick_length_s(trajectory, n), point.milling));
  }
}

}  // namespace osteomill
