#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "osteomill/session/connection.h"

namespace osteomill {

/// The result of looking for a device (HardwareKind::find).
struct FoundDevice {
  bool is_present = false;
  /// The device that was found, or why none was, in half a sentence.
  std::string text;
};

/// A kind of haptic hardware, and all that is to be known of its back end. `address` is what a user wrote
/// after the name and a colon; it may be empty.
struct HardwareKind {
  std::string_view name;
  /// The form of an address; empty if the kind has none.
  std::string_view address;
  std::string_view meaning;
  /// Looks for the device and returns what is there, after a second at most. Commands nothing: motors stay as
  /// they are, whichever program drives them. Throws InputError as `open` does.
  std::string (*probe)(const std::string& address);
  /// Opens the device. Throws InputError naming it and why it cannot be opened.
  std::unique_ptr<Connection> (*open)(const std::string& address);

  /// Looks for the device as `probe` does; a device that is not there is a result, not an exception.
  FoundDevice find(const std::string& at) const;
};

/// Opens a device of Force Dimension (delta, omega, sigma, lambda) or a Novint Falcon, by the maker's libdhd
/// or libdrd, opened at run time (docs/devices.md). `address` is its number among those connected, 0 if
/// empty. It is driven once it is calibrated, by the maker's tool. Its base B: x towards the operator, y to
/// the right, z up. Throws InputError if the library or the device cannot be had.
std::unique_ptr<Connection> open_force_dimension(const std::string& address);
/// Returns how many devices of Force Dimension are connected. Throws as `open_force_dimension`.
std::string probe_force_dimension(const std::string& address);

/// Opens a Haply Inverse3 by the maker's Inverse service, at HOST:PORT (127.0.0.1:10001 if empty):
/// versions 3.1 to 3.5 of its simulation channel (docs/devices.md). Takes the first Inverse3 that it names,
/// and the first Verse Grip, wireless before wired, without which position alone is sensed. Its base B: x to
/// the right, y away from the operator, z up. Throws InputError if no service or no Inverse3 is there.
std::unique_ptr<Connection> open_haply(const std::string& address);
/// Returns the name of the Inverse3 at the address, and whether another program uses it. Throws as
/// `open_haply`.
std::string probe_haply(const std::string& address);

/// Opens a device of 3D Systems (Touch, Touch X, Phantom) by the maker's libHD, opened at run time
/// (docs/devices.md). `address` is the name that it has in the maker's setup, the default device if empty.
/// It is driven once it is calibrated. Its base B: x to the right, y up, z towards the operator. Throws
/// InputError if the library or the device cannot be had. One at a time.
std::unique_ptr<Connection> open_touch(const std::string& address);
/// Returns the name of the device of 3D Systems. Throws as `open_touch`.
std::string probe_touch(const std::string& address);

/// Opens a device that speaks the datagrams of docs/udp-device.md, at HOST:PORT (127.0.0.1:47117 if empty).
/// Throws InputError naming the address if that is none, nothing answers within half a second, or what
/// answers does not keep to the protocol.
std::unique_ptr<Connection> open_udp(const std::string& address);
/// Returns the name of the device at the address, and whether another program uses it. Throws as `open_udp`.
std::string probe_udp(const std::string& address);

/// Returns every kind that there is a back end for.
std::span<const HardwareKind> hardware_kinds();
/// Returns the kind of that name; null if there is none.
const HardwareKind* hardware_named(std::string_view name);

}  // namespace osteomill
