#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <thread>

#include "osteomill/base/latest_value.h"
#include "osteomill/base/recent_rate.h"
#include "osteomill/session/connection.h"
#include "osteomill/session/device.h"
#include "osteomill/session/workspace.h"

namespace osteomill {

/// Function that opens a device and returns its connection, or throws InputError.
using OpenConnection = std::function<std::unique_ptr<Connection>()>;

/// State of a device for display.
struct DeviceReport {
  enum class State : unsigned char {
    ok,
    /// Driven, with a remark for the operator (`reason`).
    remark,
    /// Gives poses but may not be driven, e.g. not calibrated or its force switched off (`reason`).
    not_driven,
    /// No input for longer than 5 ms.
    silent,
    /// Gives poses that are not finite or whose quaternion is not a rotation.
    not_finite,
    /// Disconnected; being reopened.
    lost,
    /// A call into the vendor library (`reason`) does not return.
    hangs,
  };
  State state = State::ok;
  /// Time in this state.
  double since_s = 0;
  /// If the device is lost, why it cannot be opened; otherwise the device's own remark.
  std::string reason;
  double inputs_per_s = 0;
  /// Recent position of the handle.
  Vec3 handle_B_mm = Vec3::Zero();
  /// Number of times that the device left `ok`, that the haptic thread's wrench was too old, and that the
  /// device was reopened.
  std::uint64_t faults = 0;
  std::uint64_t late_wrenches = 0;
  std::uint64_t reopened = 0;
  /// Returns the device's fault as a sentence without its subject and full stop; empty if there is none.
  std::string complaint() const;
  bool gives_poses() const { return state <= State::not_driven; }
};

/// Haptic hardware of any back end as a session's device. Its own thread reads from and writes to the
/// connection, so that the hardware never blocks a tick, and supervises both sides. Wrenches are clamped to
/// the device's limits, and successive ones differ by at most kHandWrenchRates in a millisecond. The wrench
/// ramps down to zero if the requested one is older than 5 ms, if the device may not be driven, is lost or
/// disengaged, and on closing; it rises again over 0.1 s. A lost device is reopened until that succeeds.
///
/// The device is driven (`is_driven`) while the latest input permits it, it is not lost, and it is not
/// disengaged (`disengage`). The clutch leaves it driven, because the tool stays in place.
///
/// The first button requests the spindle. While the second is held (or `set_clutched`), the handle moves
/// without the tool: the device gives no pose and the hand feels nothing. Afterwards motion continues from
/// the tool's position.
class ConnectedDevice final : public Device {
 public:
  static constexpr unsigned kSpindleButton = 1;
  static constexpr unsigned kClutchButton = 2;

  /// Opens the device. Throws as `open` does. `now_s` is a monotonic clock that tests may replace.
  explicit ConnectedDevice(OpenConnection open, std::function<double()> now_s = {});
  /// Closes the device.
  ~ConnectedDevice() override;
  ConnectedDevice(const ConnectedDevice&) = delete;
  ConnectedDevice& operator=(const ConnectedDevice&) = delete;

  /// Starts the thread and waits for the first pose. Throws InputError if none arrives within half a second.
  void start();
  /// Sends zero, closes the device and returns an empty string. If a call into the vendor library does not
  /// return within 0.8 s, detaches the thread and returns a message; the device then gives no poses and takes
  /// no wrenches.
  std::string close();
  /// Runs one iteration of the thread's loop. For tests with their own clock, instead of `start`.
  void exchange();

  const DeviceCapabilities& capabilities() const { return capabilities_; }

  /// Sets the mapping from handle to tool; the tool keeps its pose. For one thread besides the haptic one
  /// (the window's). Throws std::invalid_argument as Workspace does.
  void set_workspace(const WorkspaceSettings& settings);
  /// Sets the rotation from the operator's view V to W; default: view_from_the_front(). For the thread that
  /// calls `set_workspace`.
  void set_view(const Quat& R_WV);
  const WorkspaceSettings& workspace() const { return requested_mapping_.settings; }
  /// Returns `limits`, reduced to what the device can give, in W (Workspace::limits_W).
  WrenchLimits limits_W(const WrenchLimits& limits) const {
    return Workspace(capabilities_, workspace()).limits_W(limits);
  }
  /// Engages or releases the clutch, like the handle's second button. Any thread.
  void set_clutched(bool clutched) { clutched_.store(clutched, std::memory_order_relaxed); }
  /// Returns the state of the device. Any thread except the haptic one.
  DeviceReport report() const;

  Pose read_pose() noexcept override;
  void write_wrench(const Wrench& wrench) noexcept override;
  double delivered_fraction() const noexcept override;
  bool is_driven() const noexcept override { return is_driven_; }
  bool is_spindle_requested() const noexcept override { return (buttons_ & kSpindleButton) != 0; }
  void tick_done(const Pose& X_WT, double dt_s) noexcept override;
  void put_at(const Pose& X_WD) noexcept override;
  bool disengage() noexcept override;
  void engage() noexcept override;

 private:
  // State of the device's thread, which shares ownership in case it is detached.
  class DeviceLoop;
  struct Mapping {
    WorkspaceSettings settings;
    Quat R_WV = view_from_the_front();
    std::uint64_t number = 0;
  };

  std::shared_ptr<DeviceLoop> exchange_;
  std::thread thread_;
  Mapping requested_mapping_;
  LatestValue<Mapping> mapping_;
  std::atomic<bool> clutched_{false};

  // Used by the haptic thread only.
  DeviceCapabilities capabilities_;
  Workspace workspace_;
  Pose X_WD_;
  Pose X_WT_;
  bool has_pose_ = false;
  bool needs_anchor_ = true;
  std::uint64_t reconnects_ = 0;
  std::uint64_t gate_ = 0;
  std::uint64_t disengage_count_ = 0;
  bool is_driven_ = false;
  std::uint64_t mapping_number_ = 0;
  unsigned buttons_ = 0;
};

}  // namespace osteomill
