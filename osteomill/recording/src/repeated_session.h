#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/recording/recording.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Throws an InputError that names the recording.
[[noreturn]] void refuse(const Recording& recording, const std::string& reason);
/// Throws InputError, naming the recording, if it is empty, lost ticks or continues another recording.
void require_complete(const Recording& recording);
/// Returns the index of the tick after a session's last one.
std::size_t session_end(const Recording& recording, std::size_t session);

/// Calls `make`, and turns its std::invalid_argument for settings out of range into an InputError.
template <typename Make>
auto made(const Recording& recording, const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    refuse(recording, fmt::format("cannot be replayed: {}", error.what()));
  }
}

/// Repeats the milling of a recorded session tick by tick from the tool's recorded poses and forces.
class RepeatedSession {
 public:
  /// Starts before any tick of the session, with `bone` and `memory`, the mill's internal state, as they were
  /// then. `bone` and `recording` must outlive this object. Throws InputError, naming the recording, if its
  /// settings are missing or out of range.
  RepeatedSession(Volume& bone, const Recording& recording, std::size_t session, std::size_t tick,
                  const BurrMill::Memory& memory = {});

  /// Mills the next tick. Throws InputError, naming the recording and the tick, if the removed volume differs
  /// from the recorded one.
  VolumeChange mill_next();
  BurrMill::Memory memory() const { return mill_.memory(); }

 private:
  const Recording& recording_;
  SessionSettings settings_;
  MillingSettings milling_;
  BurrMill mill_;
  std::size_t tick_;
  double removed_mm3_;
};

}  // namespace osteomill
