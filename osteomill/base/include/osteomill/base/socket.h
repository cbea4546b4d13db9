#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace osteomill {

struct HostAndPort {
  std::string host;
  int port = 0;
};

/// Splits "HOST:PORT" and resolves the host to a numeric address. Throws InputError naming `device` and the
/// address if it is malformed, or the name cannot be resolved within 400 ms.
HostAndPort resolve_address(std::string_view device, const std::string& address);

/// Client side of a connection; never blocks longer than the given timeout. For one thread at a time.
class Socket {
 public:
  enum class Kind : unsigned char { stream, datagrams };

  /// Connects to `at`, as returned by `resolve_address`. Throws InputError naming `device` on failure, or,
  /// for a stream, if the connection is not established within 400 ms.
  Socket(const std::string& device, const HostAndPort& at, Kind kind);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Returns false once the peer is found to be gone.
  bool is_open() const { return socket_ >= 0; }
  /// Returns whether data are available, or arrive within `wait`.
  bool wait_to_receive(std::chrono::milliseconds wait) const;
  /// Fills `bytes` with received data (a longer datagram is truncated) and returns the number of bytes;
  /// nothing if none have arrived.
  std::optional<std::size_t> receive(std::span<unsigned char> bytes);
  /// Sends without blocking and returns the number of bytes sent. A datagram is sent completely or not at
  /// all.
  std::size_t send(std::span<const unsigned char> bytes);
  /// Sends all bytes. Closes the connection if that takes longer than `wait`, because half a message is
  /// useless.
  void send_all(std::span<const unsigned char> bytes, std::chrono::milliseconds wait);

 private:
  bool wait_for(short events, std::chrono::milliseconds wait) const;
  void close();

  Kind kind_;
  int socket_ = -1;
};

}  // namespace osteomill
