#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "osteomill/exercise/attempt.h"

namespace osteomill {

/// A stretch of an attempt in which the burr did what it should not.
struct Moment {
  enum class Kind : unsigned char { contact, outside };
  /// Whether the turning burr reached into a structure, or took bone outside the target.
  Kind kind = Kind::contact;
  /// The structure of a contact, by its place among the exercise's.
  std::size_t structure = 0;
  /// Its first and its last tick, and the length of those between that belong to it.
  std::size_t first_tick = 0;
  std::size_t last_tick = 0;
  double time_s = 0;
  /// The greatest force of the burr in those.
  double force_max_N = 0;
  /// The bone taken outside the target; 0 of a contact.
  double removed_mm3 = 0;
};

/// Returns the contacts with one structure, or with the nearest of all: ticks in which the turning burr's
/// surface reached into it. Half a second without parts one from the next.
std::vector<Moment> contacts_of(const Attempt& attempt, std::optional<std::size_t> structure = {});

/// Returns the removals of bone that counts as outside the target (PlacedExercise::is_outside). One ends
/// after half a second without, or when the burr is 3 mm from its beginning.
std::vector<Moment> outside_removals_of(const Attempt& attempt);

/// Returns the contacts with each structure and the removals outside the target, by time.
std::vector<Moment> moments_of(const Attempt& attempt);

/// Returns the burr's speed about a tick, over 10 ms, mm/s; not a number if it has no place there.
double burr_speed_mm_s(const Attempt& attempt, std::size_t tick);

}  // namespace osteomill
