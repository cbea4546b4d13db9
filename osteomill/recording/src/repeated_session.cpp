#include "repeated_session.h"

#include "osteomill/milling/cutting_reaction.h"

namespace osteomill {

namespace {

void require_same_removal(const Recording& recording, std::size_t tick, double removed_mm3) {
  const double recorded_mm3 = recording.records[tick].removed_mm3;
  if (removed_mm3 == recorded_mm3) return;
  if (tick == 0) {
    refuse(recording,
           fmt::format("continues other milling: {:.6g} mm³ had been removed before it began", recorded_mm3));
  }
  refuse(recording, fmt::format("was made with another scan ({}) or version ({}): at tick {} it had removed "
                                "{:.9g} mm³, the replay {:.9g} mm³",
                                recording.description.scan_name, recording.description.program_version, tick,
                                recorded_mm3, removed_mm3));
}

}  // namespace

void refuse(const Recording& recording, const std::string& reason) {
  throw InputError(recording.path.string(), reason);
}

void require_complete(const Recording& recording) {
  if (recording.sessions.empty()) refuse(recording, "holds no ticks");
  if (recording.dropped > 0)
    refuse(recording, fmt::format("lost {} ticks, so it cannot be replayed", recording.dropped));
  if (const std::string& before = recording.sessions.front().start.continues_from; !before.empty())
    refuse(recording, "continues " + before + ", without which it cannot be replayed");
}

std::size_t session_end(const Recording& recording, std::size_t session) {
  return session + 1 < recording.sessions.size() ? recording.sessions[session + 1].first
                                                 : recording.records.size();
}

RepeatedSession::RepeatedSession(Volume& bone, const Recording& recording, std::size_t session,
                                 std::size_t tick, const BurrMill::Memory& memory)
    : recording_(recording),
      settings_(session_settings(recording.sessions[session].start.run, recording.path)),
      milling_(made(recording, [&] { return milling_settings(settings_.setup); })),
      mill_(made(recording,
                 [&] {
                   return BurrMill(bone, settings_.setup.tool.burr_radius_mm, settings_.densities, milling_);
                 })),
      tick_(tick),
      removed_mm3_(tick == recording.sessions[session].first ? recording.sessions[session].start.removed_mm3
                                                             : recording.records[tick - 1].removed_mm3) {
  mill_.resume_from(memory);
}

VolumeChange RepeatedSession::mill_next() {
  const TickRecord& record = recording_.records[tick_];
  VolumeChange change;
  if (!record.paused) {
    const Vec3 paying_W_N = paying_force_W_N(milling_, record.X_WT, record.burr_force_W_N, record.spindle_on);
    const double speed_share =
        settings_.setup.handpiece == Handpiece::none ? 1 : record.spindle_rpm / milling_.spindle_speed_rpm;
    const MillingStep step = mill_.step(record.X_WT.position_mm, paying_W_N, record.dt_s, speed_share);
    removed_mm3_ += step.removed_mm3;
    change = step.change;
  }
  require_same_removal(recording_, tick_, removed_mm3_);
  ++tick_;
  return change;
}

}  // namespace osteomill
