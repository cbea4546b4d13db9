#include "osteomill/session/hardware.h"

#include <algorithm>
#include <array>

#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

constexpr std::array kKinds{
    HardwareKind{"dhd", "NUMBER", "Force Dimension and Falcon, through the vendor's libdhd",
                 &probe_force_dimension, &open_force_dimension},
    HardwareKind{"haply", "HOST:PORT", "Haply Inverse3, through the vendor's service", &probe_haply,
                 &open_haply},
    HardwareKind{"hd", "NAME", "3D Systems Touch and Phantom, through the vendor's libHD", &probe_touch,
                 &open_touch},
    HardwareKind{"udp", "HOST:PORT", "a laboratory's own device, through UDP datagrams (docs/udp-device.md)",
                 &probe_udp, &open_udp},
};

}  // namespace

FoundDevice HardwareKind::find(const std::string& at) const {
  try {
    return {true, probe(at)};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

std::span<const HardwareKind> hardware_kinds() {
  return kKinds;
}

const HardwareKind* hardware_named(std::string_view name) {
  const auto found = std::ranges::find(kKinds, name, &HardwareKind::name);
  return found == kKinds.end() ? nullptr : &*found;
}

}  // namespace osteomill
