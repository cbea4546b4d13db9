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

/// Streams the bone while it is milled, and the tool, to an OpenIGTLink receiver (3D Slicer). IMAGE messages
/// named OsteomillBone carry the scan's densities as 32-bit floats: first the whole image, then, at most
/// twice a second and only after a change, the bounding box of everything milled so far as a sub-volume.
/// TRANSFORM messages named OsteomillTool (X_WT) and STRING messages named OsteomillReadings follow at the
/// given rate. All coordinates are in the patient's axes (RAS, as the protocol requires). Sends from its own
/// thread; other threads wait at most while it copies such a box.
class BoneSender {
 public:
  /// Connects to `address`, HOST:PORT. `bone` must outlive this. Throws InputError if the address is
  /// malformed, nothing listens there, or the bone does not fit into a message (2 GiB). The destructor sends
  /// the final bone if that takes no longer than two seconds.
  BoneSender(const BoneFollower& bone, const std::string& address, double tool_rate_Hz);

  /// Sets the tool state to send next. Any thread.
  void show_tool(const TickRecord& now);
  /// Returns false once the receiver has disconnected; nothing is sent after that. Any thread.
  bool is_connected() const { return is_connected_.load(std::memory_order_relaxed); }

 private:
  void run(const std::stop_token& stop, Socket& stream);

  const BoneFollower& bone_;
  std::chrono::duration<double> between_tools_;
  std::atomic<bool> is_connected_{true};
  std::mutex mutex_;
  std::condition_variable_any end_;
  std::optional<TickRecord> tool_;
  // Last member, so that the thread ends before the members it uses are destroyed.
  std::jthread thread_;
};

}  // namespace osteomill
