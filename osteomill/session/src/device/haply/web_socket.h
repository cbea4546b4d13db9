#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace osteomill {

/// A client's end of a WebSocket that carries texts. For one thread at a time.
class WebSocket {
 public:
  /// Connects to HOST:PORT. Throws InputError about `device` if nothing answers within 400 ms. Texts of
  /// more than `max_bytes` break the connection off.
  WebSocket(const std::string& device, const std::string& host, int port, std::size_t max_bytes);
  ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  bool is_open() const;
  /// The newest whole text that has come, or that comes within `wait`.
  std::optional<std::string> receive(std::chrono::microseconds wait);
  /// Sends a text without waiting, in place of one that could not be sent yet. Returns false if this could
  /// not either.
  bool send(std::string text);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
