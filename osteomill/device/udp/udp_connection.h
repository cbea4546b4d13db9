#pragma once

#include <memory>
#include <string>

#include "osteomill/device/connection.h"
#include "osteomill/device/hardware.h"

namespace osteomill {

/// Where a device is looked for that has no address.
inline constexpr const char* kUdpAddress = "127.0.0.1:47117";

/// A device that speaks the datagrams of docs/udp-device.md, at HOST:PORT (of its own, or kUdpAddress).
/// Throws InputError naming the address where that is none, nothing answers within half a second, or what
/// answers does not keep to the protocol.
std::unique_ptr<Connection> open_udp(const std::string& address);
FoundDevice find_udp(const std::string& address);

}  // namespace osteomill
