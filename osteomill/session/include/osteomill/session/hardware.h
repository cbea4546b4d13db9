#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "osteomill/session/connection.h"

namespace osteomill {

/// Result of HardwareKind::find.
struct FoundDevice {
  bool is_present = false;
  /// Description of the device, or the reason why none was found; a phrase.
  std::string text;
};

/// A kind of haptic hardware and its back end. The user selects it as `name` or `name:address`; the address
/// may be empty.
struct HardwareKind {
  std::string_view name;
  /// Format of an address; empty if the kind takes none.
  std::string_view address;
  std::string_view meaning;
  /// Looks for the device and returns its description, within one second. Sends no commands, so another
  /// program that drives the motors is not disturbed. Throws InputError as `open` does.
  std::string (*probe)(const std::string& address);
  /// Opens the device. Throws InputError with its name and the reason if it cannot be opened.
  std::unique_ptr<Connection> (*open)(const std::string& address);

  /// Probes for the device, but returns a failure as a result instead of throwing.
  FoundDevice find(const std::string& at) const;
};

/// Opens a Force Dimension device (delta, omega, sigma, lambda) or a Novint Falcon through the vendor's
/// libdhd or libdrd, loaded at run time (docs/devices.md). `address` is its number among the connected
/// devices; 0 if empty. It is driven once it has been calibrated with the vendor's tool. Base frame B: x
/// towards the operator, y to the right, z up. Throws InputError if the library or the device is not
/// available.
std::unique_ptr<Connection> open_force_dimension(const std::string& address);
/// Returns the number of Force Dimension devices connected, as a phrase. Throws as `open_force_dimension`
/// does.
std::string probe_force_dimension(const std::string& address);

/// Opens a Haply Inverse3 through the vendor's Inverse service at HOST:PORT (127.0.0.1:10001 if empty), using
/// versions 3.1 to 3.5 of its simulation channel (docs/devices.md). Uses the first Inverse3 listed and the
/// first Verse Grip, wireless before wired; without a grip only position is sensed. Base frame B: x to the
/// right, y away from the operator, z up. Throws InputError if the service or the Inverse3 is not available.
std::unique_ptr<Connection> open_haply(const std::string& address);
/// Returns the name of the Inverse3 at the address, and whether another program uses it. Throws as
/// `open_haply` does.
std::string probe_haply(const std::string& address);

/// Opens a 3D Systems device (Touch, Touch X, Phantom) through the vendor's libHD, loaded at run time
/// (docs/devices.md). `address` is its name in the vendor's setup; the default device if empty. It is driven
/// once it has been calibrated. Base frame B: x to the right, y up, z towards the operator. Throws InputError
/// if the library or the device is not available. Only one can be open at a time.
std::unique_ptr<Connection> open_touch(const std::string& address);
/// Returns the name of the 3D Systems device. Throws as `open_touch` does.
std::string probe_touch(const std::string& address);

/// Opens a device that implements the protocol of docs/udp-device.md at HOST:PORT (127.0.0.1:47117 if empty).
/// Throws InputError with the address if it is malformed, nothing answers within half a second, or the answer
/// violates the protocol.
std::unique_ptr<Connection> open_udp(const std::string& address);
/// Returns the name of the device at the address, and whether another program uses it. Throws as `open_udp`
/// does.
std::string probe_udp(const std::string& address);

/// Returns all kinds of hardware with a back end.
std::span<const HardwareKind> hardware_kinds();
/// Returns the kind with this name, or null.
const HardwareKind* hardware_named(std::string_view name);

}  // namespace osteomill
