#include "osteomill/device/connected_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include <fmt/core.h>

#include "osteomill/device/real_time.h"
#include "osteomill/files/input_error.h"
#include "osteomill/geometry/wrench.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;
using State = DeviceReport::State;

// What is older is no longer true: an input (the haptic thread then has no pose, and sends zero) and a wrench
// (the device is then sent zero, whatever the haptic thread is doing).
constexpr double kMaxAge_s = 5e-3;
// How long it takes to come up where the device may be driven (again).
constexpr double kBlend_s = 0.1;
// After this long without a pose the tool goes on from where it is, not from where the hand is by then.
constexpr double kGone_s = 0.1;
constexpr double kReopen_s = 0.5;
// However long ago the last wrench went out, the next makes no larger a step than in this time.
constexpr double kRound_s = 1e-3;
constexpr double kUnitTolerance = 1e-3;
constexpr int kWaitsForPose = 500;
// What it takes to come down from anything, and then some.
constexpr int kMostRoundsAtTheEnd = 50;

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
  }
  return {};
}

ConnectedDevice::ConnectedDevice(OpenConnection open, std::function<double()> now_s)
    : open_(std::move(open)),
      now_s_(now_s ? std::move(now_s) : &steady_now_s),
      connection_(open_()),
      sent_s_(now_s_()),
      to_say_{.state = State::silent, .since_s = sent_s_},
      said_(to_say_),
      capabilities_(connection_->capabilities()),
      workspace_(capabilities_, {}) {}

ConnectedDevice::~ConnectedDevice() {
  let_go();
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void ConnectedDevice::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  DeviceReport now = report();
  for (int n = 0; n < kWaitsForPose && !now.gives_poses(); ++n, now = report())
    std::this_thread::sleep_for(1ms);
  if (!now.gives_poses()) throw InputError(capabilities_.name, now.complaint());
}

void ConnectedDevice::run(const std::stop_token& stop) {
  const SignalsForOthers none_here;
  request_real_time();
  while (!stop.stop_requested()) {
    exchange();
    if (!connection_) std::this_thread::sleep_for(1ms);
  }
  if (connection_) come_down();
  at_rest_.store(true, std::memory_order_release);
}

void ConnectedDevice::exchange() {
  try {
    if (!connection_) {
      at_rest_.store(true, std::memory_order_release);
      reopen();
    } else {
      DeviceInput input;
      const ConnectionStatus heard = connection_->read(input);
      if (heard == ConnectionStatus::fresh) hear(input);
      const double now_s = now_s_();
      if (heard == ConnectionStatus::lost || send(now_s, may_be_driven(now_s)) == ConnectionStatus::lost)
        lose("the connection was closed");
    }
  } catch (const std::exception& error) {
    // A back end that throws breaks its contract.
    lose(error.what());
  }
  judge();
}

void ConnectedDevice::hear(const DeviceInput& input) {
  const double now_s = now_s_();
  newest_.input = input;
  newest_.at_s = now_s;
  newest_.is_pose = is_pose(input.X_DH);
  if (newest_.is_pose) {
    if (now_s - posed_s_ > kGone_s) ++newest_.returns;
    posed_s_ = now_s;
  }
  heard_.write(newest_);
  inputs_.count();
}

bool ConnectedDevice::may_be_driven(double now_s) {
  const Asked& asked = asked_.read();
  const bool late = now_s - asked.at_s > kMaxAge_s;
  if (late && !wrench_was_late_ && !is_zero(asked.wrench_D)) ++to_say_.late_wrenches;
  wrench_was_late_ = late;
  return !late && newest_.input.not_driven == nullptr && !let_go_.load(std::memory_order_acquire);
}

// The only way by which a wrench goes out.
ConnectionStatus ConnectedDevice::send(double now_s, bool driven) {
  const double lapse_s = connection_->capabilities().lets_go_after_s;
  if (lapse_s > 0 && now_s - sent_s_ > lapse_s) sent_D_ = {};
  const double passed_s = std::clamp(now_s - sent_s_, 0.0, kMaxAge_s);
  const double share = driven ? std::min(1.0, blended_ + passed_s / kBlend_s) : 0;
  const Wrench asked = make_safe(asked_.read().wrench_D, capabilities_.limits).wrench;
  const Wrench target{share * asked.force_N, share * asked.torque_Nmm};
  const Wrench next = approach(sent_D_, target, kRatesForAHand, std::min(passed_s, kRound_s));
  const ConnectionStatus status = connection_->write(next);
  if (status == ConnectionStatus::fresh) {
    sent_D_ = next;
    sent_s_ = now_s;
  }
  if (status == ConnectionStatus::fresh || share == 0) blended_ = share;
  given_share_.store(driven ? share_sent(asked.force_N, sent_D_.force_N) : 0, std::memory_order_relaxed);
  at_rest_.store(is_zero(sent_D_), std::memory_order_release);
  return status;
}

// A round a millisecond, until zero has gone out; what cannot be sent any more is left to the device itself.
void ConnectedDevice::come_down() {
  double now_s = sent_s_;
  try {
    for (int n = 0; n < kMostRoundsAtTheEnd && !is_zero(sent_D_); ++n) {
      const ConnectionStatus status = send(now_s += kRound_s, false);
      if (status == ConnectionStatus::lost) return;
      std::this_thread::sleep_for(1ms);
      DeviceInput unread;
      if (status == ConnectionStatus::silent) connection_->read(unread);
    }
  } catch (const std::exception&) {
  }
}

void ConnectedDevice::lose(const std::string& reason) {
  if (connection_) come_down();
  connection_.reset();
  sent_D_ = {};
  blended_ = 0;
  given_share_.store(0, std::memory_order_relaxed);
  lost_s_ = now_s_();
  to_say_.reason = reason;
}

void ConnectedDevice::reopen() {
  if (now_s_() - lost_s_ < kReopen_s) return;
  connection_ = open_();
  const DeviceCapabilities& now = connection_->capabilities();
  if (now.name != capabilities_.name || now.driven != capabilities_.driven ||
      now.sensed != capabilities_.sensed) {
    lose("another device is there: " + now.name);
    return;
  }
  sent_s_ = now_s_();
  ++to_say_.reopened;
}

void ConnectedDevice::judge() {
  const double now_s = now_s_();
  const DeviceInput& input = newest_.input;
  to_say_.inputs_per_s = inputs_.per_s(now_s);
  State state = State::ok;
  const char* says = "";
  if (!connection_) {
    state = State::lost;
  } else if (now_s - newest_.at_s > kMaxAge_s) {
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
  if (connection_) to_say_.reason = says;
  tell(state, now_s);
}

void ConnectedDevice::tell(State state, double now_s) {
  if (state != to_say_.state) {
    if (to_say_.state == State::ok) ++to_say_.faults;
    to_say_.state = state;
    to_say_.since_s = now_s;
  }
  to_say_.handle_D_mm = newest_.input.X_DH.position_mm;
  if (const std::unique_lock lock(said_mutex_, std::try_to_lock); lock) said_ = to_say_;
}

void ConnectedDevice::set_workspace(const WorkspaceSettings& settings) {
  require_valid(settings);
  way_set_.settings = settings;
  ++way_set_.number;
  way_.write(way_set_);
}

void ConnectedDevice::set_view(const Quat& R_WV) {
  if (way_set_.R_WV.coeffs() == R_WV.coeffs()) return;
  way_set_.R_WV = R_WV;
  ++way_set_.number;
  way_.write(way_set_);
}

DeviceReport ConnectedDevice::report() const {
  const std::lock_guard lock(said_mutex_);
  DeviceReport report = said_;
  report.since_s = now_s_() - report.since_s;
  return report;
}

Pose ConnectedDevice::read_pose() noexcept {
  const Heard& heard = heard_.read();
  const DeviceInput& input = heard.input;
  const bool there = heard.is_pose && now_s_() - heard.at_s <= kMaxAge_s;
  const bool clutched =
      clutched_.load(std::memory_order_relaxed) || (there && (input.buttons & kClutchButton) != 0);
  has_pose_ = there && !clutched;
  buttons_ = has_pose_ ? input.buttons : 0;
  if (clutched) anchor_anew_ = true;
  if (!has_pose_) return kNoPose;
  if (std::exchange(returns_, heard.returns) != heard.returns) anchor_anew_ = true;
  if (const Way& way = way_.read(); std::exchange(way_taken_, way.number) != way.number) {
    workspace_.set(way.settings, way.R_WV);
    workspace_.anchor(X_WD_, input.X_DH);
  }
  if (std::exchange(anchor_anew_, false)) workspace_.anchor(X_WT_, input.X_DH);
  X_WD_ = workspace_.tool_pose(input.X_DH);
  return X_WD_;
}

void ConnectedDevice::write_wrench(const Wrench& wrench) noexcept {
  asked_.write({workspace_.wrench_D(wrench, shaft_direction(X_WD_)), now_s_()});
}

void ConnectedDevice::tick_done(const Pose& X_WT, double /*dt_s*/) noexcept {
  if (has_pose_ && is_finite(X_WT)) X_WT_ = X_WT;
}

void ConnectedDevice::put_at(const Pose& X_WD) noexcept {
  X_WT_ = X_WD;
  anchor_anew_ = true;
}

bool ConnectedDevice::let_go() noexcept {
  // What is being sent right now may still be something.
  if (!let_go_.exchange(true, std::memory_order_acq_rel)) at_rest_.store(false, std::memory_order_release);
  return at_rest_.load(std::memory_order_acquire);
}

}  // namespace osteomill
