#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "osteomill/device/latest_value.h"
#include "osteomill/live/crash_stop.h"
#include "osteomill/live/live_timing.h"
#include "osteomill/session/milling_session.h"

namespace osteomill {

/// Hears of every tick in the haptic thread, after the wrench has gone out: what was recorded, the bone, and
/// where it changed. Must keep to the rules of the tick: no allocation, lock, log, exception or system call.
using TickListener = std::function<void(const TickRecord&, const Volume&, const VolumeChange&)>;

/// What the haptic thread is doing.
struct LiveState {
  TickRecord record;
  bool spindle_on = false;
  bool paused = false;
  /// MillingSession::intersection_W.
  std::optional<Vec3> intersection_W = {};
};

/// A milling session in real time: a thread of its own ticks it at 1 kHz, with real-time scheduling where the
/// system allows it. Nothing that other threads do makes a tick wait.
///
/// One other thread commands and reads the state (the window's). Commands take effect at the next tick; each
/// gives the number under which it can be waited for. On stopping, however it comes about, the device is sent
/// a wrench of zero; so it is when the program crashes (crash_stop.h), hence one live session at a time.
class LiveSession {
 public:
  using CommandNumber = std::uint64_t;

  /// `device` outlives this object. Does not start yet.
  LiveSession(std::unique_ptr<MillingSession> session, Device& device);
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  void start();
  /// Returns when the last tick is over and zero has been sent. Can be started again.
  void stop();

  /// The device's own button or pedal turns the spindle on as well.
  CommandNumber set_spindle(bool on);
  /// A pause sends zero and neither steps nor mills.
  CommandNumber set_paused(bool paused);
  /// While held nothing is milled, though everything is felt: the volume may then be read from other threads,
  /// once the command is done.
  CommandNumber hold_bone(bool held);
  /// Another algorithm, tool, setting or bone, prepared beforehand.
  CommandNumber replace(std::unique_ptr<MillingSession> session);
  /// The tool to a pose free of bone, however far away. The wrench fades in a hundred ticks, in which nothing
  /// is milled, so that the hand feels no step; then the device is put there (Device::put_at), and the
  /// algorithm begins anew. One at a time: nothing while `placing`.
  CommandNumber place(const Pose& X_WD);
  bool placing() const { return placing_.load(std::memory_order_acquire); }
  /// In place of the listener before, which is no longer called once the command is done. May be empty.
  CommandNumber listen(TickListener listener);
  /// What the session of the last `replace` that is done began from.
  const TakenOver& taken_over() const { return taken_over_; }
  bool is_done(CommandNumber number) const {
    return commands_done_.load(std::memory_order_acquire) >= number;
  }
  /// Returns when the command has taken effect: a tick or two.
  void wait_for(CommandNumber number);

  /// Of the last tick.
  const LiveState& state() { return state_.read(); }
  /// Every tick's record in turn, as long as they are taken often enough: the queue holds 4 s, and what finds
  /// it full is left out.
  std::optional<TickRecord> next_record();
  /// From any thread.
  TimingSummary timing() const { return timing_.summary(); }
  /// In one line what real-time scheduling was refused, or nothing. Valid once started.
  const std::string& refused_real_time() const { return refused_real_time_; }
  bool running() const { return running_.load(std::memory_order_acquire); }
  /// True where it stopped because the device threw.
  bool failed() const { return failed_.load(std::memory_order_relaxed); }

  /// The session now in use. Its volume only while held, or while not running.
  const MillingSession& session() const { return *session_; }

 private:
  struct SetSpindle {
    bool on;
  };
  struct SetPaused {
    bool paused;
  };
  struct HoldBone {
    bool held;
  };
  struct Replace {
    std::unique_ptr<MillingSession> session;
  };
  struct Place {
    Pose X_WD;
  };
  struct Listen {
    std::unique_ptr<TickListener> listener;
  };
  using Action = std::variant<std::monostate, SetSpindle, SetPaused, HoldBone, Replace, Place, Listen>;
  struct Queues;

  CommandNumber send(Action action);
  void run() noexcept;
  void tick_until_stopped();
  void take_commands();
  void destroy_retired();
  void apply(Action& action);
  bool place_when_at_rest();
  TickRecord tick(double time_s, double dt_s);
  TickRecord step(double time_s, double dt_s, bool mills);

  Device& device_;
  CrashStop crash_stop_;
  std::thread thread_;
  std::atomic<bool> running_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> failed_{false};
  std::string refused_real_time_;

  // The haptic thread's while it runs.
  std::unique_ptr<MillingSession> session_;
  std::unique_ptr<TickListener> listener_;
  bool spindle_ = false;
  bool paused_ = false;
  bool bone_held_ = false;
  double time_s_ = 0;
  std::uint32_t session_number_ = 0;
  TakenOver taken_over_;
  Place place_;
  bool letting_go_ = false;
  std::atomic<bool> placing_{false};

  std::unique_ptr<Queues> queues_;
  std::atomic<CommandNumber> commands_done_{0};
  CommandNumber commands_sent_ = 0;

  LatestValue<LiveState> state_;
  LiveTiming timing_;
};

}  // namespace osteomill
