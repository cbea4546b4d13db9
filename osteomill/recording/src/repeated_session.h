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

/// Throws InputError that names the recording.
[[noreturn]] void refuse(const Recording& recording, const std::string& reason);
/// Throws InputError, naming the recording, if not all of its ticks from a scan on are there.
void require_whole(const Recording& recording);
/// Returns the number of the tick after a session's last one.
std::size_t end_of(const Recording& recording, std::size_t session);

/// Makes an object from settings that may be out of range.
template <typename Make>
auto made(const Recording& recording, const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    refuse(recording, fmt::format("cannot be run again: {}", error.what()));
  }
}

/// Mills a bone as a session of a recording did, tick by tick, from the tool's recorded poses and forces.
class RepeatedSession {
 public:
  /// Begins at any tick of the session: `bone` is as it was before that tick, and `memory` as the session's
  /// mill was then. Both outlive it. Throws InputError, naming the recording, if its settings are at fault.
  RepeatedSession(Volume& bone, const Recording& recording, std::size_t session, std::size_t tick,
                  const BurrMill::Memory& memory = {});

  /// Mills the next tick. Throws InputError, naming the recording and the tick, if it does not remove what
  /// was recorded.
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
