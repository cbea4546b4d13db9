#include "osteomill/live/live_session.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "osteomill/device/real_time.h"
#include "osteomill/numbers/spsc_queue.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

// A tick that comes later than this mills and moves as if it came at this time.
constexpr double kMaxTick_s = 0.02;

constexpr std::size_t kCommands = 255;

}  // namespace

struct LiveSession::Queues {
  // From the commanding thread and back: what was replaced is destroyed where it was made. What is sent back
  // always finds room: at most `kCommands` were under way when the last one was sent, and before that all
  // that had come back was taken.
  SpscQueue<Action> commands{kCommands};
  SpscQueue<Action> retired{2 * kCommands + 1};
  SpscQueue<TickRecord> records{4096};
};

LiveSession::LiveSession(std::unique_ptr<MillingSession> session, Device& device)
    : device_(device),
      crash_stop_(device),
      session_(std::move(session)),
      queues_(std::make_unique<Queues>()) {
  session_->guard().protect_a_hand();
}

LiveSession::~LiveSession() {
  stop();
}

void LiveSession::start() {
  if (running()) return;
  stop();
  failed_.store(false, std::memory_order_relaxed);
  stopping_.store(false, std::memory_order_relaxed);
  running_.store(true, std::memory_order_release);
  std::atomic<bool> ready{false};
  thread_ = std::thread([this, &ready] {
    CrashStop::give_this_thread_a_stack();
    refused_real_time_ = request_real_time();
    ready.store(true, std::memory_order_release);
    run();
  });
  while (!ready.load(std::memory_order_acquire)) std::this_thread::sleep_for(100us);
}

void LiveSession::stop() {
  stopping_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
  // What was sent and not yet taken takes effect all the same.
  take_commands();
  destroy_retired();
}

LiveSession::CommandNumber LiveSession::send(Action action) {
  destroy_retired();
  while (!queues_->commands.try_push(std::move(action))) {
    if (!running()) take_commands();
    std::this_thread::sleep_for(200us);
  }
  ++commands_sent_;
  if (!running()) {
    // It may only just be ending.
    if (thread_.joinable()) thread_.join();
    take_commands();
  }
  return commands_sent_;
}

LiveSession::CommandNumber LiveSession::set_spindle(bool on) {
  return send(SetSpindle{on});
}

LiveSession::CommandNumber LiveSession::set_paused(bool paused) {
  return send(SetPaused{paused});
}

LiveSession::CommandNumber LiveSession::hold_bone(bool held) {
  return send(HoldBone{held});
}

LiveSession::CommandNumber LiveSession::replace(std::unique_ptr<MillingSession> session) {
  return send(Replace{std::move(session)});
}

LiveSession::CommandNumber LiveSession::place(const Pose& X_WD) {
  if (placing()) return commands_sent_;
  placing_.store(true, std::memory_order_release);
  return send(Place{X_WD});
}

LiveSession::CommandNumber LiveSession::listen(TickListener listener) {
  return send(Listen{listener ? std::make_unique<TickListener>(std::move(listener)) : nullptr});
}

void LiveSession::wait_for(CommandNumber number) {
  while (!is_done(number)) {
    if (!running()) {
      if (thread_.joinable()) thread_.join();
      destroy_retired();
      take_commands();
    }
    std::this_thread::sleep_for(200us);
  }
}

void LiveSession::run() noexcept {
  try {
    tick_until_stopped();
  } catch (...) {
    // A device that throws breaks its contract.
    failed_.store(true, std::memory_order_relaxed);
  }
  try {
    device_.write_wrench(Wrench{});
    crash_stop_.stopped();
  } catch (...) {
  }
  running_.store(false, std::memory_order_release);
}

void LiveSession::tick_until_stopped() {
  constexpr double kTick_s = 1e-3;
  constexpr Nanoseconds kTick_ns = 1'000'000;
  NextDeadline next{monotonic_now_ns() + kTick_ns, 1};
  while (!stopping_.load(std::memory_order_acquire) && !crash_stop_.asked()) {
    TickTimes times{next.deadline_ns, 0, 0, next.periods};
    times.woke_ns = wait_until(next.deadline_ns);
    take_commands();
    const double passed_s = next.periods * kTick_s;
    const TickRecord record = tick(time_s_, std::min(passed_s, kMaxTick_s));
    times.done_ns = monotonic_now_ns();
    timing_.add(times, record);
    next = next_deadline(next.deadline_ns, times.done_ns, kTick_ns);
    time_s_ += next.periods * kTick_s;
    device_.tick_done(record.X_WT, next.periods * kTick_s);
  }
}

void LiveSession::take_commands() {
  Action action;
  while (queues_->commands.try_pop(action)) {
    apply(action);
    // What is left in the action is what it replaced.
    queues_->retired.try_push(std::move(action));
    commands_done_.fetch_add(1, std::memory_order_release);
  }
}

void LiveSession::destroy_retired() {
  Action action;
  while (queues_->retired.try_pop(action)) {
  }
}

std::optional<TickRecord> LiveSession::next_record() {
  TickRecord record;
  if (!queues_->records.try_pop(record)) return std::nullopt;
  return record;
}

void LiveSession::apply(Action& action) {
  if (const auto* spindle = std::get_if<SetSpindle>(&action)) {
    spindle_ = spindle->on;
  } else if (const auto* pause = std::get_if<SetPaused>(&action)) {
    paused_ = pause->paused;
  } else if (const auto* hold = std::get_if<HoldBone>(&action)) {
    bone_held_ = hold->held;
  } else if (auto* replace = std::get_if<Replace>(&action)) {
    std::swap(session_, replace->session);
    taken_over_ = replace->session->left();
    session_->guard().protect_a_hand();
    session_->take_over(taken_over_);
    if (letting_go_) session_->let_go();
    ++session_number_;
  } else if (const auto* place = std::get_if<Place>(&action)) {
    place_ = *place;
    letting_go_ = true;
    session_->let_go();
  } else if (auto* listen = std::get_if<Listen>(&action)) {
    std::swap(listener_, listen->listener);
  }
}

// True in the tick in which the tool comes to its place.
bool LiveSession::place_when_at_rest() {
  if (!letting_go_ || !session_->guard().is_at_rest()) return false;
  device_.put_at(place_.X_WD);
  session_->place();
  letting_go_ = false;
  return true;
}

TickRecord LiveSession::tick(double time_s, double dt_s) {
  const bool placed = place_when_at_rest();
  const bool spindle_on = !paused_ && !letting_go_ && (spindle_ || device_.spindle_asked());
  TickRecord record = step(time_s, dt_s, spindle_on && !bone_held_);
  record.session = session_number_;
  if (listener_) (*listener_)(record, session_->volume(), session_->last_change());
  state_.write({record, spindle_on, paused_, session_->intersection_W()});
  if (placed) placing_.store(false, std::memory_order_release);
  queues_->records.try_push(record);
  return record;
}

TickRecord LiveSession::step(double time_s, double dt_s, bool mills) {
  return paused_ ? session_->idle_tick(device_, time_s, dt_s) : session_->tick(device_, time_s, dt_s, mills);
}

}  // namespace osteomill
