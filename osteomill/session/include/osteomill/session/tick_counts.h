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

/// Counts the ticks whose wrench could not be sent unchanged. Call `add` with every TickRecord; it is safe in
/// the haptic tick.
class FaultCount {
 public:
  void add(const TickRecord& record) noexcept;
  /// Returns the number of wrenches clamped to the device's limits.
  int limited() const;
  /// Returns the number of ticks in which the wrench fell to zero because the wrench was not finite.
  int not_finite() const;
  /// Returns the number of ticks in which the wrench fell to zero because the device gave no pose.
  int without_pose() const;
  /// Returns the number of ticks in which the wrench fell to zero because the pose jumped or the tick was
  /// late.
  int unsafe() const;
  /// Returns the number of ticks that sent zero because the hand was held back (WrenchGuard).
  int held_back() const;
  /// Returns a summary for display, or nothing if all counts are 0. Not for the haptic tick.
  std::optional<std::string> sentence() const;

 private:
  int count(std::initializer_list<WrenchFault> faults) const;

  // The number of ticks of each kind.
  std::array<int, static_cast<std::size_t>(WrenchFault::held_back) + 1> ticks_{};
};

/// Accumulates removed bone, contact times and forces per label. Call `add` with every tick. Not for the
/// haptic tick.
class LabelCount {
 public:
  /// Totals of one label.
  struct Entry {
    /// In mm^3 of reference density, as in TickRecord.
    double removed_mm3 = 0;
    /// Times of the burr's first and last contact, cutting or not.
    double first_s = 0;
    double last_s = 0;
    /// Total contact time, and the burr's force on bone during it.
    double time_s = 0;
    double force_mean_N = 0;
    double force_max_N = 0;
    /// Number of contacts, separated by at least 0.5 s without contact.
    int contacts = 0;
  };

  explicit LabelCount(std::vector<Label> labels) : labels_(std::move(labels)), entries_(labels_.size()) {}
  /// Uses the labels of `map`; none if it is null.
  explicit LabelCount(const std::shared_ptr<const LabelMap>& map = nullptr)
      : LabelCount(map ? map->labels() : std::vector<Label>{}) {}

  /// Adds a tick. Returns a message for display if a contact with a no-go label begins in it.
  std::optional<std::string> add(const TickRecord& record);

  /// Returns the time of the last contact with a no-go label.
  std::optional<double> last_no_go_s() const;

  const std::vector<Label>& labels() const { return labels_; }
  /// Returns the totals, one entry per label.
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Label> labels_;
  std::vector<Entry> entries_;
};

/// Returns one line per label that was touched, without line feeds.
std::vector<std::string> label_lines(const LabelCount& count);

}  // namespace osteomill
