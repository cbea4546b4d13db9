#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "osteomill/device/host_and_port.h"

namespace osteomill {

/// A client's end of a TCP connection that never waits longer than it is told to. For one thread at a time.
class TcpStream {
 public:
  /// Throws InputError about `device` where nothing answers within 400 ms.
  TcpStream(const std::string& device, const HostAndPort& at);
  ~TcpStream();
  TcpStream(const TcpStream&) = delete;
  TcpStream& operator=(const TcpStream&) = delete;

  bool is_open() const { return socket_ >= 0; }
  /// Appends what has come, or comes within `wait`, `most` bytes at the most.
  void receive(std::vector<unsigned char>& bytes, std::size_t most, std::chrono::milliseconds wait);
  /// Sends all of it; what does not go out within `wait` ends the connection, since half a message is none.
  void send(std::span<const unsigned char> bytes, std::chrono::milliseconds wait);

 private:
  bool wait_for(short events, std::chrono::milliseconds wait) const;
  void close();

  int socket_ = -1;
};

}  // namespace osteomill
