#include "osteomill/base/socket.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <future>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"

namespace osteomill {

namespace {

constexpr std::chrono::milliseconds kConnectWithin{400};
constexpr std::chrono::milliseconds kResolveWithin{400};

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS;
}

// Prefers IPv4, because most servers on "localhost" listen there.
std::string numeric_address(const addrinfo* found) {
  const addrinfo* best = found;
  for (const addrinfo* other = found; other != nullptr && best->ai_family != AF_INET; other = other->ai_next)
    if (other->ai_family == AF_INET) best = other;
  std::array<char, NI_MAXHOST> number{};
  ::getnameinfo(best->ai_addr, best->ai_addrlen, number.data(), number.size(), nullptr, 0, NI_NUMERICHOST);
  return number.data();
}

// Returns the address of a host; empty if its name is unknown. Resolves it in a detached thread, so that
// an unresponsive name server delays neither reopening a device nor ending the program.
std::string resolve_host(const std::string& host) {
  std::promise<std::string> promise;
  std::future<std::string> number = promise.get_future();
  std::thread([host, promise = std::move(promise)]() mutable {
    addrinfo* found = nullptr;
    const bool known = getaddrinfo(host.c_str(), nullptr, nullptr, &found) == 0;
    promise.set_value(known ? numeric_address(found) : "");
    if (known) freeaddrinfo(found);
  }).detach();
  return number.wait_for(kResolveWithin) == std::future_status::ready ? number.get() : "";
}

}  // namespace

HostAndPort resolve_address(std::string_view device, const std::string& address) {
  const std::size_t colon = address.rfind(':');
  HostAndPort at;
  if (colon != std::string::npos && colon > 0) {
    at.host = address.substr(0, colon);
    at.port = parse_number<decltype(at.port)>(std::string_view(address).substr(colon + 1)).value_or(0);
    if (at.port > 0 && at.port <= 65535) {
      at.host = resolve_host(at.host);
      if (!at.host.empty()) return at;
      throw InputError(fmt::format("{}:{}", device, address), "no such host is known");
    }
  }
  throw InputError(fmt::format("{}:{}", device, address), "is not of the form HOST:PORT");
}

Socket::Socket(const std::string& device, const HostAndPort& at, Kind kind) : kind_(kind) {
  addrinfo hints{};
  hints.ai_socktype = kind == Kind::stream ? SOCK_STREAM : SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(at.host.c_str(), std::to_string(at.port).c_str(), &hints, &found);
      error != 0)
    throw InputError(device, gai_strerror(error));
  socket_ = ::socket(found->ai_family, found->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  // Also for datagrams, to ignore those from other senders.
  int reason = socket_ >= 0 && ::connect(socket_, found->ai_addr, found->ai_addrlen) == 0 ? 0 : errno;
  freeaddrinfo(found);
  if (reason == EINPROGRESS) {
    socklen_t size = sizeof(reason);
    reason = ETIMEDOUT;
    if (wait_for(POLLOUT, kConnectWithin)) ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &reason, &size);
  }
  if (reason != 0) {
    close();
    throw InputError(device, std::strerror(reason));
  }
  const int at_once = 1;
  if (kind == Kind::stream) ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof(at_once));
}

Socket::~Socket() {
  close();
}

bool Socket::wait_to_receive(std::chrono::milliseconds wait) const {
  return wait_for(POLLIN, wait);
}

std::optional<std::size_t> Socket::receive(std::span<unsigned char> bytes) {
  const ssize_t length = ::recv(socket_, bytes.data(), bytes.size(), 0);
  const bool is_over = length == 0 && kind_ == Kind::stream;
  if (length >= 0 && !is_over) return static_cast<std::size_t>(length);
  if (is_over || !would_block()) close();
  return std::nullopt;
}

std::size_t Socket::send(std::span<const unsigned char> bytes) {
  const ssize_t length = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (length < 0 && !would_block()) close();
  return static_cast<std::size_t>(std::max<ssize_t>(length, 0));
}

void Socket::send_all(std::span<const unsigned char> bytes, std::chrono::milliseconds wait) {
  const auto end = std::chrono::steady_clock::now() + wait;
  for (bytes = bytes.subspan(send(bytes)); is_open() && !bytes.empty(); bytes = bytes.subspan(send(bytes))) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0 || !wait_for(POLLOUT, left)) close();
  }
}

bool Socket::wait_for(short events, std::chrono::milliseconds wait) const {
  pollfd wanted{socket_, events, 0};
  return ::poll(&wanted, 1, static_cast<int>(wait.count())) > 0;
}

void Socket::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

}  // namespace osteomill
