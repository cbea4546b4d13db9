#include "osteomill/live/haptic_thread.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>

#include "osteomill/base/real_time.h"
#include "osteomill/base/spsc_queue.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

// Upper bound on the time simulated in one tick, however late it comes.
constexpr double kMaxTick_s = 0.02;
// Capacity of the queue to the commanding thread: 4 s at 4 kHz.
constexpr std::size_t kMaxRecords = 16384;

}  // namespace

HapticThread::HapticThread(std::unique_ptr<MillingSession> session, Device& device, TickClock clock,
                           double time_s)
    : clock_(std::move(clock)),
      device_(device),
      driven_(device),
      session_(std::move(session)),
      time_s_(time_s),
      records_(std::make_unique<SpscQueue<TickRecord>>(kMaxRecords)),
      timing_(1e6 * session_->setup().tick_s) {}

HapticThread::~HapticThread() = default;

void HapticThread::start() {
  if (is_running()) return;
  stop();
  failure_ = nullptr;
  std::atomic<bool> ready{false};
  running_.store(true, std::memory_order_release);
  try {
    thread_ = std::jthread([this, &ready](const std::stop_token& stop) {
      CrashStop::install_signal_stack();
      refused_real_time_ = request_real_time().value_or("");
      ready.store(true, std::memory_order_release);
      run(stop);
    });
  } catch (...) {
    running_.store(false, std::memory_order_release);
    throw;
  }
  while (!ready.load(std::memory_order_acquire)) std::this_thread::sleep_for(100us);
}

void HapticThread::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

// Commands swap replaced objects into variables of the commanding thread, so that they are destroyed there.
void HapticThread::run_between_ticks(const std::function<void()>& command) {
  command_.store(&command, std::memory_order_release);
  while (command_.load(std::memory_order_acquire) != nullptr) {
    if (!is_running()) {
      // The thread may only just be ending.
      if (thread_.joinable()) thread_.join();
      run_pending_command();
    } else {
      std::this_thread::sleep_for(200us);
    }
  }
}

void HapticThread::run_pending_command() {
  const auto* const command = command_.load(std::memory_order_acquire);
  if (command == nullptr) return;
  (*command)();
  command_.store(nullptr, std::memory_order_release);
}

void HapticThread::set_spindle(bool on) {
  run_between_ticks([&] { spindle_ = on; });
}

void HapticThread::set_paused(bool paused) {
  run_between_ticks([&] { paused_ = paused; });
}

void HapticThread::freeze_bone(bool frozen) {
  run_between_ticks([&] { bone_frozen_ = frozen; });
}

SessionHandover HapticThread::replace(std::unique_ptr<MillingSession> session) {
  SessionHandover left;
  run_between_ticks([&] {
    std::swap(session_, session);
    left = session->handover();
    session_->resume_from(left);
    if (fading_out_) session_->fade_out();
    ++session_number_;
  });
  return left;
}

void HapticThread::place(const Pose& X_WD) {
  if (is_placing()) return;
  placing_.store(true, std::memory_order_release);
  run_between_ticks([&] {
    X_WD_place_ = X_WD;
    fading_out_ = true;
    session_->fade_out();
  });
}

void HapticThread::set_listener(TickListener listener) {
  run_between_ticks([&] { std::swap(listener_, listener); });
}

void HapticThread::run(const std::stop_token& stop) noexcept {
  driven_.note_started();
  session_->hold_back();
  try {
    tick_until(stop);
  } catch (...) {
    failure_ = std::current_exception();
  }
  try {
    device_.write_wrench(Wrench{});
    driven_.note_stopped();
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
  }
  running_.store(false, std::memory_order_release);
}

void HapticThread::tick_until(const std::stop_token& stop) {
  // Consecutive sessions have the same rate.
  const double tick_s = session_->setup().tick_s;
  const Nanoseconds tick_ns = std::llround(tick_s * 1e9);
  NextDeadline next{clock_.now_ns() + tick_ns, 1};
  while (!stop.stop_requested() && !driven_.is_stop_requested()) {
    TickTimes times{next.deadline_ns, 0, 0, next.periods};
    times.woke_ns = clock_.wait_until(next.deadline_ns);
    run_pending_command();
    const TickRecord record = tick(std::min((next.periods - 1) * tick_s, kMaxTick_s - tick_s));
    times.done_ns = clock_.now_ns();
    timing_.add(times, record);
    next = next_deadline(next.deadline_ns, times.done_ns, tick_ns);
    time_s_ += next.periods * tick_s;
  }
}

std::optional<TickRecord> HapticThread::next_record() {
  TickRecord record;
  if (!records_->try_pop(record)) return std::nullopt;
  return record;
}

// Called in every tick until one has placed the tool, because the session may be replaced meanwhile and the
// device may return no pose for a while.
void HapticThread::place_if_at_rest() {
  if (!fading_out_ || !session_->guard().is_at_rest()) return;
  device_.put_at(X_WD_place_);
  session_->place();
}

TickRecord HapticThread::tick(double late_s) {
  place_if_at_rest();
  const bool spindle_on = !paused_ && !fading_out_ && (spindle_ || device_.is_spindle_requested());
  TickRecord record = session_->tick(device_, {.time_s = time_s_,
                                               .dt_s = session_->setup().tick_s,
                                               .late_s = late_s,
                                               .spindle_on = spindle_on && !bone_frozen_,
                                               .paused = paused_});
  record.session = session_number_;
  if (record.placed) fading_out_ = false;
  if (listener_) listener_(record, session_->volume(), session_->last_change());
  state_.write({record, spindle_on, session_->intersection_W()});
  if (record.placed) placing_.store(false, std::memory_order_release);
  records_->try_push(record);
  return record;
}

}  // namespace osteomill
