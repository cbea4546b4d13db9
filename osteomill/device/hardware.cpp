#include "osteomill/device/hardware.h"

#include <algorithm>
#include <array>

namespace osteomill {

namespace {

constexpr std::array kKinds{
    HardwareKind{"dhd", "NUMBER", "Force Dimension and Falcon, by the maker's libdhd", &find_force_dimension,
                 &open_force_dimension},
    HardwareKind{"haply", "HOST:PORT", "Haply Inverse3, by the maker's service", &find_haply, &open_haply},
    HardwareKind{"hd", "NAME", "3D Systems Touch and Phantom, by the maker's libHD", &find_touch,
                 &open_touch},
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
