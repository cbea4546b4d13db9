#pragma once

#include <vector>

#include "osteomill/operator/milling_entry.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// A PNG of the bone from obliquely above the entry: all of it where it is small (a tooth), else what lies
/// around the entry. The same view whatever has been milled.
std::vector<unsigned char> picture_of_entry(const Volume& volume, const MillingEntry& entry);

}  // namespace osteomill
