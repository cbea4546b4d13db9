#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace osteomill {

/// Client end of a WebSocket for text messages. Not thread-safe.
class WebSocket {
 public:
  /// Connects to HOST:PORT. Throws InputError about `device` if nothing answers within 400 ms. Closes the
  /// connection on a message of more than `max_bytes`.
  WebSocket(const std::string& device, const std::string& host, int port, std::size_t max_bytes);
  ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  bool is_open() const;
  /// Returns the newest complete message received so far or within `wait`.
  std::optional<std::string> receive(std::chrono::microseconds wait);
  /// Sends a message without blocking, replacing one that is still pending. Returns false if the new
  /// message is still pending.
  bool send(std::string text);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
