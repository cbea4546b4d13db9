#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "osteomill/device/connection.h"

namespace osteomill {

/// What looking for a device came to.
struct FoundDevice {
  bool there = false;
  /// What is there, or why nothing is, in half a sentence.
  std::string text;
};

/// A kind of haptic hardware, and all that is to be known of its back end. `address` is what a user wrote
/// after the name and a colon, empty where nothing was.
struct HardwareKind {
  std::string_view name;
  /// What an address looks like; empty where there is none.
  std::string_view address;
  std::string_view meaning;
  /// Waits half a second at most, and throws nothing.
  FoundDevice (*find)(const std::string& address);
  /// Throws InputError naming the device and why it cannot be had.
  std::unique_ptr<Connection> (*open)(const std::string& address);
};

/// Every kind that there is a back end for.
std::span<const HardwareKind> hardware_kinds();
/// Null where there is none of that name.
const HardwareKind* hardware_named(std::string_view name);

}  // namespace osteomill
