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

/// Splits "HOST:PORT", and returns the host as the number that its name stands for. Throws InputError naming
/// `device` and the address if it is not of that form, or no name server knows it within 400 ms.
HostAndPort host_and_port(std::string_view device, const std::string& address);

/// A client's end of a connection that never waits longer than it is told to. For one thread at a time.
class Socket {
 public:
  enum class Kind : unsigned char { stream, datagrams };

  /// Connects to `at`, as `host_and_port` returns it. Throws InputError about `device` if it cannot; for a
  /// stream, if nothing answers within 400 ms.
  Socket(const std::string& device, const HostAndPort& at, Kind kind);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Returns false from the moment that the other side is found to be gone.
  bool is_open() const { return socket_ >= 0; }
  /// Returns whether something has come, or comes within `wait`.
  bool wait_to_receive(std::chrono::milliseconds wait) const;
  /// Fills `bytes` with what has come (from a datagram its beginning) and returns how many were filled;
  /// nothing if none has.
  std::optional<std::size_t> receive(std::span<unsigned char> bytes);
  /// Sends what goes out at once and returns how many bytes that is: a datagram as a whole or not at all.
  std::size_t send(std::span<const unsigned char> bytes);
  /// Sends all of it. If it does not go out within `wait`, ends the connection, because half a message is
  /// useless.
  void send_all(std::span<const unsigned char> bytes, std::chrono::milliseconds wait);

 private:
  bool wait_for(short events, std::chrono::milliseconds wait) const;
  void close();

  Kind kind_;
  int socket_ = -1;
};

}  // namespace osteomill
