#pragma once

#include "osteomill/session/milling_setup.h"
#include "osteomill/session/tick_record.h"
#include "osteomill/visual/spindle_sound.h"

namespace osteomill {

/// Returns the spindle's sound state in a tick of a session with this setup.
SpindleState spindle_state(const TickRecord& record, const MillingSetup& setup);

}  // namespace osteomill
