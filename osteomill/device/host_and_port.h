#pragma once

#include <string>
#include <string_view>

namespace osteomill {

struct HostAndPort {
  std::string host;
  int port = 0;
};

/// Of "HOST:PORT". Throws InputError naming `device` and the address where it is not of that form.
HostAndPort host_and_port(std::string_view device, const std::string& address);

}  // namespace osteomill
