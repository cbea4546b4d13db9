#pragma once

#include <memory>
#include <string>

#include "osteomill/device/connection.h"
#include "osteomill/device/hardware.h"

namespace osteomill {

/// Where an OpenIGTLink server is looked for that has no address.
inline constexpr const char* kOpenIgtLinkAddress = "127.0.0.1:18944";

/// Whatever tracks a tool and serves it by OpenIGTLink (PLUS, 3D Slicer, a robot's controller), at HOST:PORT
/// (kOpenIgtLinkAddress where empty): the handle's pose in D comes as TRANSFORM messages, the first of whose
/// names is kept; the wrench goes out as two SENSOR messages, OsteomillForce in N and OsteomillTorque in N m.
/// Throws InputError where nothing listens.
std::unique_ptr<Connection> open_openigtlink(const std::string& address);
FoundDevice find_openigtlink(const std::string& address);

}  // namespace osteomill
