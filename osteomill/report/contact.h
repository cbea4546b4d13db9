#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "osteomill/session/tick_record.h"

namespace osteomill {

/// What the tool leant on in a tick, and what the hand felt of it.
struct Contact {
  /// It presses with 0.02 N or more.
  bool burr = false;
  /// Without what cutting adds, the torque is 0.2 N mm or more, twice a step of the encoder: what presses on
  /// the burr's ball has no lever about its centre.
  bool shaft = false;
  /// The burr touches, or the hand feels 0.02 N or more.
  bool force = false;
  /// The hand feels 0.2 N mm or more.
  bool torque = false;

  bool any() const { return force || torque; }
};
Contact contact_of(const TickRecord& record);

/// For how much of a recording the tool touched, each as a share of its ticks.
struct ContactShares {
  double any = 0;
  double burr = 0;
  double shaft = 0;
  double force = 0;
  double torque = 0;
  /// When the last contact ended, from the first tick on, where the recording goes on for a second or more
  /// without any, and else not a number; 0 where there was none at all.
  double lost_after_s = std::numeric_limits<double>::quiet_NaN();
  /// It was lost with the spindle on, now or, where nothing touched at all, before the recording.
  bool lost_while_milling = false;

  bool is_lost() const { return !std::isnan(lost_after_s); }
};
ContactShares contact_shares(std::span<const TickRecord> records);

/// Whether a share of contact is enough to measure what is felt in it: a tenth of the ticks.
inline bool is_enough_contact(double share) {
  return share >= 0.1;
}

/// Why something that is felt could not be measured: "never touched", "lost while milling",
/// "lost while milling, after 3.2 s", "lost contact after 3.2 s", "touched
/// for 4 % of the time", "the shaft touched for 4 % of the time" or "felt a force for 4 % of the time".
std::string contact_words(const ContactShares& contact);

}  // namespace osteomill
