#include "osteomill/session/tick_counts.h"

#include <algorithm>

#include <fmt/core.h>

namespace osteomill {

void FaultCount::add(const TickRecord& record) noexcept {
  ++ticks_[static_cast<std::size_t>(record.fault)];
}

int FaultCount::count(std::initializer_list<WrenchFault> faults) const {
  int ticks = 0;
  for (const WrenchFault fault : faults) ticks += ticks_[static_cast<std::size_t>(fault)];
  return ticks;
}

int FaultCount::limited() const {
  using enum WrenchFault;
  return count({force_clamped, torque_clamped, force_and_torque_clamped});
}

int FaultCount::not_finite() const {
  return count({WrenchFault::not_finite});
}

int FaultCount::without_pose() const {
  return count({WrenchFault::pose_not_finite});
}

int FaultCount::unsafe() const {
  return count({WrenchFault::pose_jumped, WrenchFault::tick_late});
}

int FaultCount::held_back() const {
  return count({WrenchFault::held_back});
}

std::optional<std::string> FaultCount::sentence() const {
  if (limited() + not_finite() + without_pose() + unsafe() + held_back() == 0) return std::nullopt;
  return fmt::format(
      "{} wrenches were clamped to the device's limits, {} were not finite and sent as zero, {} were sent as "
      "zero because the device gave no pose (including while the clutch was held), {} because it jumped or "
      "the tick was late, {} because the tool had not left the bone yet after the device became driven",
      limited(), not_finite(), without_pose(), unsafe(), held_back());
}

std::optional<std::string> LabelCount::add(const TickRecord& record) {
  constexpr double kApart_s = 0.5;
  const Label* begun = nullptr;
  for (const LabelCut& cut : record.label_cuts) {
    if (cut.label == 0 || cut.label > labels_.size()) continue;
    Entry& entry = entries_[cut.label - 1u];
    const double force_N = record.burr_force_W_N.norm();
    if (entry.contacts == 0) entry.first_s = record.time_s;
    if (entry.contacts == 0 || record.time_s - entry.last_s >= kApart_s) {
      ++entry.contacts;
      if (labels_[cut.label - 1u].no_go) begun = &labels_[cut.label - 1u];
    }
    entry.last_s = record.time_s;
    entry.removed_mm3 += cut.removed_mm3;
    entry.time_s += record.dt_s;
    if (entry.time_s > 0) entry.force_mean_N += (force_N - entry.force_mean_N) * record.dt_s / entry.time_s;
    entry.force_max_N = std::max(entry.force_max_N, force_N);
  }
  if (begun == nullptr) return std::nullopt;
  return fmt::format("no-go: the burr touched {} at {:.3f} s, pressing with {:.2f} N", begun->name,
                     record.time_s, record.burr_force_W_N.norm());
}

std::optional<double> LabelCount::last_no_go_s() const {
  std::optional<double> last_s;
  for (std::size_t n = 0; n < labels_.size(); ++n) {
    if (labels_[n].no_go && entries_[n].contacts > 0)
      last_s = std::max(last_s.value_or(entries_[n].last_s), entries_[n].last_s);
  }
  return last_s;
}

std::vector<std::string> label_lines(const LabelCount& count) {
  std::vector<std::string> lines;
  for (std::size_t n = 0; n < count.labels().size(); ++n) {
    const Label& label = count.labels()[n];
    const LabelCount::Entry& entry = count.entries()[n];
    if (entry.contacts == 0) continue;
    lines.push_back(fmt::format(
        "{} {}: {:.2f} mm³ removed, first at {:.3f} s, {:.2f} s in all, force {:.2f} N mean, {:.2f} N max{}",
        label.value, label.name, entry.removed_mm3, entry.first_s, entry.time_s, entry.force_mean_N,
        entry.force_max_N, label.no_go ? " (no-go)" : ""));
  }
  return lines;
}

}  // namespace osteomill
