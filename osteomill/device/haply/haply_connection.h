#pragma once

#include <memory>
#include <string>

#include "osteomill/device/connection.h"
#include "osteomill/device/hardware.h"

namespace osteomill {

/// Where Haply's service is looked for that has no address.
inline constexpr const char* kHaplyAddress = "127.0.0.1:10001";

/// A Haply Inverse3 by the maker's Inverse service, at HOST:PORT (kHaplyAddress where empty): versions 3.1 to
/// 3.5 of its simulation channel (docs/devices.md). The first Inverse3 it names, and the first Verse Grip,
/// wireless before wired, without which position alone is sensed. Its base D: x to the right, y away from the
/// operator, z up. Throws InputError where no service or no Inverse3 is there.
std::unique_ptr<Connection> open_haply(const std::string& address);
FoundDevice find_haply(const std::string& address);

}  // namespace osteomill
