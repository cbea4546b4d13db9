#pragma once

#include <memory>
#include <string>

#include "osteomill/device/connection.h"
#include "osteomill/device/hardware.h"

namespace osteomill {

/// A device of 3D Systems (Touch, Touch X, Phantom) by the maker's libHD, opened at run time
/// (docs/devices.md). `address` is the name that it has in the maker's setup, the default device where empty.
/// It has to be calibrated already. Its base D: x to the right, y up, z towards the operator.
/// Torque goes to those that drive it, in N mm, or in N m where OSTEOMILL_HD_TORQUE_UNIT is "Nm".
/// Throws InputError where the library or the device cannot be had. One at a time.
std::unique_ptr<Connection> open_touch(const std::string& address);
FoundDevice find_touch(const std::string& address);

}  // namespace osteomill
