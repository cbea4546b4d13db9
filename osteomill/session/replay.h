#pragma once

#include <functional>
#include <vector>

#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"

namespace osteomill {

/// Runs the session along the trajectory, a tick a row, each as long as the time since the row before (the
/// first as long as the second, or 1 ms where it is alone); calls `record` after each tick.
void replay(MillingSession& session, const std::vector<TrajectoryPoint>& trajectory,
            const std::function<void(const TickRecord&)>& record);

}  // namespace osteomill
