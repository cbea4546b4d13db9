#pragma once

#include <optional>
#include <span>
#include <string>

#include "osteomill/session/tick_record.h"

namespace osteomill {

/// What the tool leant on in a tick. The burr does where it presses with 0.02 N or more. The shaft does where
/// the hand feels 0.2 N mm or more, twice a step of the encoder: what presses on the burr's ball has no lever
/// about its centre.
struct Contact {
  bool burr = false;
  bool shaft = false;
  /// Or the hand feels 0.02 N of either.
  bool any = false;
};
Contact contact_of(const TickRecord& record);

/// For how much of a recording the tool touched.
struct ContactShares {
  double any = 0;
  double burr = 0;
  double shaft = 0;
  /// When the last contact ended, from the first tick on, where the recording goes on for a second or more
  /// without any; 0 where there was none at all.
  std::optional<double> lost_after_s;

  /// Whether there is enough of it to measure what is felt: a tenth of the ticks.
  bool enough() const { return any >= 0.1; }
};
ContactShares contact_shares(std::span<const TickRecord> records);

/// "lost contact after 3.2 s", "never touched", or, where neither is true, "touched for 4 % of the time".
std::string contact_words(const ContactShares& contact);

}  // namespace osteomill
