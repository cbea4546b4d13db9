#pragma once

#include <memory>
#include <string>

#include "osteomill/device/connection.h"
#include "osteomill/device/hardware.h"

namespace osteomill {

/// A device of Force Dimension (delta, omega, sigma, lambda) or a Novint Falcon, by the maker's libdhd or
/// libdrd, opened at run time (docs/devices.md). `address` is its number among those connected, 0 where
/// empty. It has to be calibrated already. Its base D: x towards the operator, y to the right, z up. Throws
/// InputError where the library or the device cannot be had.
std::unique_ptr<Connection> open_force_dimension(const std::string& address);
FoundDevice find_force_dimension(const std::string& address);

}  // namespace osteomill
