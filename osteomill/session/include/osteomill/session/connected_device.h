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

/// Opens a device: a function that returns its connection, or throws InputError.
using OpenConnection = std::function<std::unique_ptr<Connection>()>;

/// The state of a device, for people to read. From any thread.
struct DeviceReport {
  enum class State : unsigned char {
    ok,
    /// It is driven, but there is something to know (`reason`).
    remark,
    /// It gives poses, but may not be driven: not calibrated, its force switched off (`reason`).
    not_driven,
    /// No input for longer than 5 ms.
    silent,
    /// It gives poses that are not finite, or turned by no rotation.
    not_finite,
    /// Gone; it is being opened again.
    lost,
    /// A function of its maker's software (`reason`) does not return.
    hangs,
  };
  State state = State::ok;
  /// How long it has been in this state.
  double since_s = 0;
  /// If the device is lost, why it cannot be opened; else what the device reports about itself.
  std::string reason;
  double inputs_per_s = 0;
  /// The place of its handle a moment ago.
  Vec3 handle_B_mm = Vec3::Zero();
  /// Counts: how often it left `ok`, how often the haptic thread's wrench was too old, and how often it was
  /// opened again.
  std::uint64_t faults = 0;
  std::uint64_t late_wrenches = 0;
  std::uint64_t reopened = 0;
  /// Returns what is wrong with the device, in a sentence without a full stop; empty if nothing is.
  std::string complaint() const;
  bool gives_poses() const { return state <= State::not_driven; }
};

/// Haptic hardware as a session's device, whichever its back end is. A thread of its own reads the connection
/// and writes to it, so that nothing the hardware does makes a tick wait, and watches over both sides. What
/// is sent is within the device's limits, and from one wrench that has gone out to the next changes by no
/// more than kHandWrenchRates in a millisecond; it comes down to zero if the wrench is over 5 ms old, if the
/// device may not be driven, is lost or disengaged, and at the end, and comes up again over 0.1 s. A device
/// that is lost is opened again until it is there.
///
/// It is driven (`is_driven`) while the newest input says that it may be, it is not lost, and it has not been
/// disengaged (`disengage`). A clutch leaves it driven, because the tool stays in its place.
///
/// The first button asks for the spindle. While the second is held (or `set_clutched`) the handle moves
/// without the tool: the device gives no pose and the hand feels nothing. Then it goes on from where the tool
/// is.
class ConnectedDevice final : public Device {
 public:
  static constexpr unsigned kSpindleButton = 1;
  static constexpr unsigned kClutchButton = 2;

  /// Opens the device. Throws as `open` does. Tests have a clock of their own, which never goes back either.
  explicit ConnectedDevice(OpenConnection open, std::function<double()> now_s = {});
  /// Closes the device.
  ~ConnectedDevice() override;
  ConnectedDevice(const ConnectedDevice&) = delete;
  ConnectedDevice& operator=(const ConnectedDevice&) = delete;

  /// Starts the thread; returns when the device has given a pose. Throws InputError if it gives none within
  /// half a second.
  void start();
  /// Returns an empty text when zero has been sent and the device is closed. If its maker's software does not
  /// return within 0.8 s, leaves the thread to itself and returns a sentence about that; the device then
  /// gives no pose and takes no wrench.
  std::string close();
  /// Does once what the thread does over and over: for a test that keeps time itself, in place of `start`.
  void exchange();

  const DeviceCapabilities& capabilities() const { return capabilities_; }

  /// Sets how the handle moves the tool, which stays where it is. For one other thread (the window's). Throws
  /// std::invalid_argument as Workspace.
  void set_workspace(const WorkspaceSettings& settings);
  /// Sets the rotation of the operator's view, from its axes V to W (from the front unless set). For the
  /// thread that sets the workspace.
  void set_view(const Quat& R_WV);
  const WorkspaceSettings& workspace() const { return requested_mapping_.settings; }
  /// Returns the most that the device gives and `limits` allow, in W (Workspace::limits_W).
  WrenchLimits limits_W(const WrenchLimits& limits) const {
    return Workspace(capabilities_, workspace()).limits_W(limits);
  }
  /// Holds the clutch, or lets it go, as the handle's second button does. Any thread.
  void set_clutched(bool clutched) { clutched_.store(clutched, std::memory_order_relaxed); }
  /// Returns the state of the device. Any thread; not for the tick.
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
  // Belongs to the device's thread, which keeps it if it is left to itself.
  class Exchange;
  struct Mapping {
    WorkspaceSettings settings;
    Quat R_WV = view_from_the_front();
    std::uint64_t number = 0;
  };

  std::shared_ptr<Exchange> exchange_;
  std::thread thread_;
  Mapping requested_mapping_;
  LatestValue<Mapping> mapping_;
  std::atomic<bool> clutched_{false};

  // The haptic thread's.
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
