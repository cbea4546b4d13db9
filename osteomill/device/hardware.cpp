#include "osteomill/device/hardware.h"

#include <algorithm>
#include <array>

#include "osteomill/device/udp/udp_connection.h"

namespace osteomill {

namespace {

constexpr std::array kKinds{
    HardwareKind{"udp", "HOST:PORT", "a laboratory's own device, by datagrams (docs/udp-device.md)",
                 &find_udp, &open_udp},
};

}  // namespace

std::span<const HardwareKind> hardware_kinds() {
  return kKinds;
}

const HardwareKind* hardware_named(std::string_view name) {
  const auto found = std::ranges::find(kKinds, name, &HardwareKind::name);
  return found == kKinds.end() ? nullptr : &*found;
}

}  // namespace osteomill
