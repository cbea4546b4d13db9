#include "osteomill/device/host_and_port.h"

#include <charconv>
#include <system_error>

#include <fmt/core.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

HostAndPort host_and_port(std::string_view device, const std::string& address) {
  const std::size_t colon = address.rfind(':');
  HostAndPort at;
  if (colon != std::string::npos && colon > 0) {
    at.host = address.substr(0, colon);
    const char* const end = address.data() + address.size();
    const auto [stopped, error] = std::from_chars(address.data() + colon + 1, end, at.port);
    if (error == std::errc() && stopped == end && at.port > 0 && at.port <= 65535) return at;
  }
  throw InputError(fmt::format("{}:{}", device, address), "is not of the form HOST:PORT");
}

}  // namespace osteomill
