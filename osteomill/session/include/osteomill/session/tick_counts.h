#pragma once

#include <array>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/session/tick_record.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Counts the ticks whose wrench could not be sent as it was, from every TickRecord in turn. `add` is safe in
/// the haptic tick.
class FaultCount {
 public:
  void add(const TickRecord& record) noexcept;
  /// Returns how many wrenches were shortened to the device's limits.
  int limited() const;
  /// Returns how many ticks sent zero because the wrench was not finite.
  int not_finite() const;
  /// Returns how many ticks sent zero because the device gave no pose.
  int without_pose() const;
  /// Returns how many ticks sent zero because the pose jumped or the tick came too late.
  int unsafe() const;
  /// Returns how many ticks sent zero because the hand was held back (WrenchGuard).
  int held_back() const;
  /// Returns a sentence about them for people to read; nothing if there were none. Not for the tick.
  std::optional<std::string> sentence() const;

 private:
  int count(std::initializer_list<WrenchFault> faults) const;

  // The number of ticks of each kind.
  std::array<int, static_cast<std::size_t>(WrenchFault::held_back) + 1> ticks_{};
};

/// Counts how much of each label was removed, when and with what force, from every tick in turn. Not for the
/// tick.
class LabelCount {
 public:
  /// The counts of one label.
  struct Entry {
    /// In mm^3 of reference density, as TickRecord counts.
    double removed_mm3 = 0;
    /// The times at which the burr first and last cut or touched it.
    double first_s = 0;
    double last_s = 0;
    /// The time for which it did in all, and the burr's force on bone meanwhile.
    double time_s = 0;
    double force_mean_N = 0;
    double force_max_N = 0;
    /// The number of contacts; half a second without parts one from the next.
    int contacts = 0;
  };

  explicit LabelCount(std::vector<Label> labels) : labels_(std::move(labels)), entries_(labels_.size()) {}
  /// Counts a bone's labels; `map` is null if it has none.
  explicit LabelCount(const std::shared_ptr<const LabelMap>& map = nullptr)
      : LabelCount(map ? map->labels() : std::vector<Label>{}) {}

  /// Takes in a tick. Returns a sentence for people to read if a contact with a no-go label begins in it.
  std::optional<std::string> add(const TickRecord& record);

  /// Returns when the burr last cut or touched a no-go label.
  std::optional<double> last_no_go_s() const;

  const std::vector<Label>& labels() const { return labels_; }
  /// Returns the counts, one for each label.
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Label> labels_;
  std::vector<Entry> entries_;
};

/// Returns a line for each label that was cut or touched, without line feeds.
std::vector<std::string> label_lines(const LabelCount& count);

}  // namespace osteomill
