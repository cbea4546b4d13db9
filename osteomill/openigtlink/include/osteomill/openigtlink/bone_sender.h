#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "osteomill/live/bone_follower.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

class Socket;

/// Sends the bone as it is milled, and the tool, to a receiver of OpenIGTLink (3D Slicer): IMAGE messages
/// called OsteomillBone, at the beginning all of it, then, at most twice a second and only after a change,
/// the box of all that was ever milled, as a part of that image, with the scan's densities as 32-bit floats;
/// and at the rate that it was given TRANSFORM messages called OsteomillTool (X_WT) and STRING messages
/// called OsteomillReadings. All in the patient's axes (RAS, as the protocol has them). On a thread of its
/// own, for which neither the haptic thread nor anyone else waits longer than such a box takes to be copied.
class BoneSender {
 public:
  /// Connects to the address HOST:PORT. `bone` outlives this. Throws InputError if the address is none,
  /// nothing listens there, or the bone does not fit into a message (2 GiB). At its end the bone is sent as
  /// it is by then, if that takes no longer than two seconds.
  BoneSender(const BoneFollower& bone, const std::string& address, double tool_rate_Hz);

  /// Sets the state of the tool that is sent from now on. Any thread.
  void show_tool(const TickRecord& now);
  /// Returns whether the receiver is still there; nothing is sent any more if it is not. Any thread.
  bool is_connected() const { return is_connected_.load(std::memory_order_relaxed); }

 private:
  void run(const std::stop_token& stop, Socket& stream);

  const BoneFollower& bone_;
  std::chrono::duration<double> between_tools_;
  std::atomic<bool> is_connected_{true};
  std::mutex mutex_;
  std::condition_variable_any end_;
  std::optional<TickRecord> tool_;
  // Last, so that it ends before all that it uses.
  std::jthread thread_;
};

}  // namespace osteomill
