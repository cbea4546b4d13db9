#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "osteomill/exercise/attempt.h"

namespace osteomill {

/// A period of an attempt in which the burr did something wrong.
struct Moment {
  enum class Kind : unsigned char { contact, outside };
  /// The turning burr touched a structure, or removed bone outside the target.
  Kind kind = Kind::contact;
  /// Index of the touched structure in the exercise.
  std::size_t structure = 0;
  /// First and last tick, and total duration of those ticks between that belong to it.
  std::size_t first_tick = 0;
  std::size_t last_tick = 0;
  double time_s = 0;
  /// Largest force of the burr in those ticks.
  double force_max_N = 0;
  /// Bone removed outside the target; 0 for a contact.
  double removed_mm3 = 0;
};

/// Returns the contacts with one structure, or with the nearest one: periods in which the turning burr's
/// surface was in it. Half a second without contact separates two.
std::vector<Moment> contacts_of(const Attempt& attempt, std::optional<std::size_t> structure = {});

/// Returns the periods in which bone outside the target was removed (PlacedExercise::is_outside). A period
/// ends after half a second without such a removal, or when the burr is 3 mm from where it began.
std::vector<Moment> outside_removals_of(const Attempt& attempt);

/// Returns the contacts with each structure and the removals outside the target, by time.
std::vector<Moment> moments_of(const Attempt& attempt);

/// Returns the burr's speed at a tick, mm/s, from five ticks before to five after it; NaN if the burr has no
/// position there.
double burr_speed_mm_s(const Attempt& attempt, std::size_t tick);

}  // namespace osteomill
