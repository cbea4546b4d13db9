#include "osteomill/session/connected_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <mutex>
#include <utility>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/real_time.h"
#include "osteomill/base/wrench.h"

#include "device/vendor_library.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;
using State = DeviceReport::State;

// Age at which an input or a wrench expires. After that the haptic thread has no pose and requests zero, or
// the device thread sends zero, whatever the haptic thread does.
constexpr double kMaxAge_s = 5e-3;
// Duration of the rise from zero when the device may be driven (again), s.
constexpr double kBlend_s = 0.1;
// After a longer gap without poses the tool stays in place instead of jumping to the hand.
constexpr double kMaxPoseGap_s = 0.1;
constexpr double kReopen_s = 0.5;
// Upper bound on the time since the last wrench, s; limits the step of the next one.
constexpr double kRound_s = 1e-3;
constexpr double kUnitTolerance = 1e-3;
constexpr int kMaxWaitsForPose = 500;
// More rounds than the ramp from any wrench to zero takes.
constexpr int kMaxFinalRounds = 50;
// Time after which a vendor call is reported as hanging, and number of milliseconds that closing waits for
// it.
constexpr double kHangs_s = 0.1;
constexpr int kMaxWaitsForEnd = 800;

double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const Pose kNoPose{Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), Quat::Identity()};

bool is_pose(const Pose& pose) {
  return is_finite(pose) && std::abs(pose.orientation.norm() - 1) < kUnitTolerance;
}

}  // namespace

std::string DeviceReport::complaint() const {
  switch (state) {
    case State::ok:
      return {};
    case State::remark:
      return reason;
    case State::not_driven:
      return fmt::format("is not driven: it {}", reason);
    case State::silent:
      return fmt::format("has given no pose for {:.1f} s", since_s);
    case State::not_finite:
      return fmt::format("has given invalid poses for {:.1f} s", since_s);
    case State::lost:
      return fmt::format("has been gone for {:.1f} s ({})", since_s, reason);
    case State::hangs:
      return fmt::format("has not answered for {:.1f} s: {} does not return", since_s, reason);
  }
  return {};
}

// State of the device's thread; shared with it in case the thread is detached.
class ConnectedDevice::DeviceLoop {
 public:
  DeviceLoop(OpenConnection open, std::function<double()> now_s)
      : open_(std::move(open)),
        now_s_(now_s ? std::move(now_s) : &steady_now_s),
        connection_(open_()),
        opened_(connection_->capabilities()),
        sent_s_(now_s_()),
        pending_report_{.state = State::silent, .since_s = sent_s_},
        published_report_(pending_report_) {}

  // `run` calls `round` in the device's thread until `end_requested`.
  void run();
  void round();

  const DeviceCapabilities& opened() const { return opened_; }
  double now_s() const { return now_s_(); }
  DeviceReport report();

  struct ReceivedInput {
    DeviceInput input;
    double at_s = -std::numeric_limits<double>::infinity();
    bool is_pose = false;
    // Number of gaps longer than kMaxPoseGap_s before this input.
    std::uint64_t reconnects = 0;
  };
  struct RequestedWrench {
    Wrench wrench_B;
    double at_s = -std::numeric_limits<double>::infinity();
  };
  LatestValue<ReceivedInput> latest_input;
  LatestValue<RequestedWrench> requested_wrench;
  std::atomic<double> delivered_fraction{0};
  // Number of changes of whether the device may be driven; odd while it may.
  std::atomic<std::uint64_t> gate{0};
  std::atomic<bool> is_disengaged{false};
  // Number of calls that disengaged the device.
  std::atomic<std::uint64_t> disengage_count{0};
  std::atomic<bool> at_rest{true};
  std::atomic<bool> end_requested{false};
  std::atomic<bool> has_ended{false};

 private:
  void store_input(const DeviceInput& input);
  void set_gate(bool is_open);
  bool check_drivable(double now_s);
  ConnectionStatus send(double now_s, bool driven);
  void ramp_to_zero();
  void drop_connection(const std::string& reason);
  void reopen();
  void update_report();
  void publish_report(State state, double now_s);

  OpenConnection open_;
  std::function<double()> now_s_;
  std::unique_ptr<Connection> connection_;
  // The capabilities at the first opening.
  DeviceCapabilities opened_;
  ReceivedInput newest_;
  // Last wrench sent, and its time.
  Wrench sent_B_;
  double sent_s_;
  // Progress of the rise from zero, 0 to 1.
  double blended_ = 0;
  double last_pose_s_ = -std::numeric_limits<double>::infinity();
  double lost_s_ = 0;
  bool wrench_was_late_ = false;
  RecentRate inputs_;

  // Start of the thread's last round, and the vendor function that it is in, or null.
  std::atomic<double> round_s_{std::numeric_limits<double>::infinity()};
  std::atomic<const char*> call_{nullptr};
  // Report being built by the device's thread; here `since_s` is a clock time, not a duration.
  DeviceReport pending_report_;
  // Copy for other threads, guarded by the mutex; the device's thread only tries to lock it.
  std::mutex report_mutex_;
  DeviceReport published_report_;
};

ConnectedDevice::ConnectedDevice(OpenConnection open, std::function<double()> now_s)
    : exchange_(std::make_shared<DeviceLoop>(std::move(open), std::move(now_s))),
      capabilities_(exchange_->opened()),
      workspace_(capabilities_, {}) {}

ConnectedDevice::~ConnectedDevice() {
  close();
}

std::string ConnectedDevice::close() {
  disengage();
  exchange_->end_requested.store(true, std::memory_order_release);
  if (!thread_.joinable()) return {};
  for (int n = 0; n < kMaxWaitsForEnd && !exchange_->has_ended.load(std::memory_order_acquire); ++n)
    std::this_thread::sleep_for(1ms);
  if (exchange_->has_ended.load(std::memory_order_acquire)) {
    thread_.join();
    return {};
  }
  thread_.detach();
  return report().complaint();
}

void ConnectedDevice::start() {
  thread_ = std::thread([exchange = exchange_] { exchange->run(); });
  DeviceReport now = report();
  for (int n = 0; n < kMaxWaitsForPose && !now.gives_poses(); ++n, now = report())
    std::this_thread::sleep_for(1ms);
  if (!now.gives_poses()) throw InputError(capabilities_.name, now.complaint());
}

void ConnectedDevice::exchange() {
  exchange_->round();
}

void ConnectedDevice::DeviceLoop::run() {
  const BlockedSignals none_here;
  const VendorCallTracker named(call_);
  request_real_time();
  while (!end_requested.load(std::memory_order_acquire)) {
    round_s_.store(now_s_(), std::memory_order_relaxed);
    round();
    if (!connection_) std::this_thread::sleep_for(1ms);
  }
  round_s_.store(now_s_(), std::memory_order_relaxed);
  if (connection_) ramp_to_zero();
  connection_.reset();
  at_rest.store(true, std::memory_order_release);
  has_ended.store(true, std::memory_order_release);
}

void ConnectedDevice::DeviceLoop::round() {
  try {
    if (!connection_) {
      at_rest.store(true, std::memory_order_release);
      reopen();
    } else {
      DeviceInput input;
      const ConnectionStatus status = connection_->read(input);
      if (status == ConnectionStatus::fresh) store_input(input);
      const double now_s = now_s_();
      if (status == ConnectionStatus::lost || send(now_s, check_drivable(now_s)) == ConnectionStatus::lost)
        drop_connection("the connection was closed");
    }
  } catch (const std::exception& error) {
    // Back ends must not throw; treat it as a lost connection.
    drop_connection(error.what());
  }
  update_report();
}

void ConnectedDevice::DeviceLoop::store_input(const DeviceInput& input) {
  const double now_s = now_s_();
  newest_.input = input;
  newest_.at_s = now_s;
  newest_.is_pose = is_pose(input.X_BH);
  if (newest_.is_pose) {
    if (now_s - last_pose_s_ > kMaxPoseGap_s) ++newest_.reconnects;
    last_pose_s_ = now_s;
  }
  // Set the gate before publishing the pose, so that a pose of a device that is not driven never appears as
  // driven.
  set_gate(input.not_driven == nullptr && !is_disengaged.load(std::memory_order_acquire));
  latest_input.write(newest_);
  inputs_.count();
}

void ConnectedDevice::DeviceLoop::set_gate(bool is_open) {
  const std::uint64_t number = gate.load(std::memory_order_relaxed);
  if (is_open != (number % 2 == 1)) gate.store(number + 1, std::memory_order_release);
}

bool ConnectedDevice::DeviceLoop::check_drivable(double now_s) {
  const RequestedWrench& newest_wrench = requested_wrench.read();
  const bool late = now_s - newest_wrench.at_s > kMaxAge_s;
  if (late && !wrench_was_late_ && !is_zero(newest_wrench.wrench_B)) ++pending_report_.late_wrenches;
  wrench_was_late_ = late;
  if (is_disengaged.load(std::memory_order_acquire)) set_gate(false);
  return !late && gate.load(std::memory_order_relaxed) % 2 == 1;
}

// Sends the next wrench on the way to the requested one. The only function that calls Connection::write.
ConnectionStatus ConnectedDevice::DeviceLoop::send(double now_s, bool driven) {
  const double lapse_s = connection_->capabilities().watchdog_s;
  if (lapse_s > 0 && now_s - sent_s_ > lapse_s) {
    sent_B_ = {};
    blended_ = 0;
  }
  const double passed_s = std::clamp(now_s - sent_s_, 0.0, kMaxAge_s);
  const double share = driven ? std::min(1.0, blended_ + passed_s / kBlend_s) : 0;
  const Wrench wanted = make_safe(requested_wrench.read().wrench_B, opened_.limits).wrench;
  const Wrench target = share * wanted;
  const Wrench next = approach(sent_B_, target, kHandWrenchRates, std::min(passed_s, kRound_s));
  const ConnectionStatus status = connection_->write(next);
  if (status == ConnectionStatus::fresh) {
    sent_B_ = next;
    sent_s_ = now_s;
  }
  if (status == ConnectionStatus::fresh || share == 0) blended_ = share;
  delivered_fraction.store(driven ? sent_fraction(wanted.force_N, sent_B_.force_N) : 0,
                           std::memory_order_relaxed);
  at_rest.store(is_zero(sent_B_), std::memory_order_release);
  return status;
}

// Ramps the wrench down to zero, one step per millisecond. If sending fails, the device has to stop by
// itself.
void ConnectedDevice::DeviceLoop::ramp_to_zero() {
  double now_s = sent_s_;
  try {
    for (int n = 0; n < kMaxFinalRounds && !is_zero(sent_B_); ++n) {
      const ConnectionStatus status = send(now_s += kRound_s, false);
      if (status == ConnectionStatus::lost) return;
      std::this_thread::sleep_for(1ms);
      DeviceInput unread;
      if (status == ConnectionStatus::silent) connection_->read(unread);
    }
  } catch (const std::exception&) {
  }
}

void ConnectedDevice::DeviceLoop::drop_connection(const std::string& reason) {
  if (connection_) ramp_to_zero();
  connection_.reset();
  set_gate(false);
  // The remarks of the lost device are obsolete.
  newest_.input.not_driven = newest_.input.remark = nullptr;
  sent_B_ = {};
  blended_ = 0;
  delivered_fraction.store(0, std::memory_order_relaxed);
  lost_s_ = now_s_();
  pending_report_.reason = reason;
}

void ConnectedDevice::DeviceLoop::reopen() {
  if (now_s_() - lost_s_ < kReopen_s) return;
  connection_ = open_();
  const DeviceCapabilities& now = connection_->capabilities();
  if (now.name != opened_.name || now.driven != opened_.driven || now.sensed != opened_.sensed) {
    drop_connection("another device is connected: " + now.name);
    return;
  }
  sent_s_ = now_s_();
  ++pending_report_.reopened;
}

void ConnectedDevice::DeviceLoop::update_report() {
  const double now_s = now_s_();
  const DeviceInput& input = newest_.input;
  pending_report_.inputs_per_s = inputs_.per_s(now_s);
  State state = State::ok;
  const char* says = "";
  const double age_s = now_s - newest_.at_s;
  // A remark of the device is more useful than the report that it is slightly slow.
  const double silent_after_s =
      input.not_driven != nullptr || input.remark != nullptr ? kMaxPoseGap_s : kMaxAge_s;
  if (!connection_) {
    state = State::lost;
  } else if (age_s > silent_after_s) {
    state = State::silent;
  } else if (!newest_.is_pose) {
    state = State::not_finite;
  } else if (input.not_driven != nullptr) {
    state = State::not_driven;
    says = input.not_driven;
  } else if (input.remark != nullptr) {
    state = State::remark;
    says = input.remark;
  }
  if (connection_) pending_report_.reason = says;
  publish_report(state, now_s);
}

void ConnectedDevice::DeviceLoop::publish_report(State state, double now_s) {
  if (state != pending_report_.state) {
    if (pending_report_.state == State::ok) ++pending_report_.faults;
    pending_report_.state = state;
    pending_report_.since_s = now_s;
  }
  pending_report_.handle_B_mm = newest_.input.X_BH.position_mm;
  if (const std::unique_lock lock(report_mutex_, std::try_to_lock); lock) published_report_ = pending_report_;
}

void ConnectedDevice::set_workspace(const WorkspaceSettings& settings) {
  require_valid(settings);
  requested_mapping_.settings = settings;
  ++requested_mapping_.number;
  mapping_.write(requested_mapping_);
}

void ConnectedDevice::set_view(const Quat& R_WV) {
  if (requested_mapping_.R_WV.coeffs() == R_WV.coeffs()) return;
  requested_mapping_.R_WV = R_WV;
  ++requested_mapping_.number;
  mapping_.write(requested_mapping_);
}

DeviceReport ConnectedDevice::report() const {
  return exchange_->report();
}

DeviceReport ConnectedDevice::DeviceLoop::report() {
  const std::lock_guard lock(report_mutex_);
  DeviceReport report = published_report_;
  const double now_s = now_s_();
  const double round_s = round_s_.load(std::memory_order_relaxed);
  const char* const call = call_.load(std::memory_order_acquire);
  if (call != nullptr && now_s - round_s > kHangs_s) {
    report.state = State::hangs;
    report.reason = call;
    report.since_s = round_s;
  }
  report.since_s = now_s - report.since_s;
  return report;
}

Pose ConnectedDevice::read_pose() noexcept {
  const DeviceLoop::ReceivedInput& latest_input = exchange_->latest_input.read();
  const std::uint64_t gate = exchange_->gate.load(std::memory_order_acquire);
  const std::uint64_t disengage_count = exchange_->disengage_count.load(std::memory_order_acquire);
  // Also false for one tick if the device was not driven at any time since the last tick.
  is_driven_ = gate % 2 == 1 && gate == gate_ && disengage_count == disengage_count_ &&
               !exchange_->is_disengaged.load(std::memory_order_acquire);
  gate_ = gate;
  disengage_count_ = disengage_count;
  const DeviceInput& input = latest_input.input;
  const bool has_fresh_pose = latest_input.is_pose && exchange_->now_s() - latest_input.at_s <= kMaxAge_s;
  const bool clutched =
      clutched_.load(std::memory_order_relaxed) || (has_fresh_pose && (input.buttons & kClutchButton) != 0);
  has_pose_ = has_fresh_pose && !clutched;
  buttons_ = has_pose_ ? input.buttons : 0;
  if (clutched) needs_anchor_ = true;
  if (!has_pose_) return kNoPose;
  if (std::exchange(reconnects_, latest_input.reconnects) != latest_input.reconnects) needs_anchor_ = true;
  if (const Mapping& mapping = mapping_.read();
      std::exchange(mapping_number_, mapping.number) != mapping.number) {
    workspace_.set(mapping.settings, mapping.R_WV);
    workspace_.anchor(X_WD_, input.X_BH);
  }
  if (std::exchange(needs_anchor_, false)) workspace_.anchor(X_WT_, input.X_BH);
  X_WD_ = workspace_.tool_pose(input.X_BH);
  return X_WD_;
}

void ConnectedDevice::write_wrench(const Wrench& wrench) noexcept {
  exchange_->requested_wrench.write(
      {workspace_.wrench_B(wrench, shaft_direction(X_WD_)), exchange_->now_s()});
}

void ConnectedDevice::tick_done(const Pose& X_WT, double /*dt_s*/) noexcept {
  if (has_pose_ && is_finite(X_WT)) X_WT_ = X_WT;
}

void ConnectedDevice::put_at(const Pose& X_WD) noexcept {
  X_WT_ = X_WD;
  needs_anchor_ = true;
}

double ConnectedDevice::delivered_fraction() const noexcept {
  return exchange_->delivered_fraction.load(std::memory_order_relaxed);
}

bool ConnectedDevice::disengage() noexcept {
  // A wrench that the device's thread is sending right now may not be zero.
  if (!exchange_->is_disengaged.exchange(true, std::memory_order_acq_rel)) {
    exchange_->disengage_count.fetch_add(1, std::memory_order_release);
    exchange_->at_rest.store(false, std::memory_order_release);
  }
  return exchange_->at_rest.load(std::memory_order_acquire);
}

void ConnectedDevice::engage() noexcept {
  exchange_->is_disengaged.store(false, std::memory_order_release);
}

}  // namespace osteomill
