#pragma once

#include "osteomill/recording/recording.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Mills the bone as the recording did: `volume` is the scan as it was when the recording began, and is
/// afterwards as it was when the recording ended, density by density; its isovalue plays no part and stays.
/// Throws InputError, naming the recording, where it was made with another scan, lost ticks, goes on from the
/// milling of another recording, or does not say how the bone was milled; the bone is then in part milled.
/// Not for the tick.
void repeat_milling(Volume& volume, const Recording& recording);

}  // namespace osteomill
