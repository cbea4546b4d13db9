#include "osteomill/device/openigtlink/tcp_stream.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

constexpr std::chrono::milliseconds kConnectWithin{400};

bool would_wait() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

TcpStream::TcpStream(const std::string& device, const HostAndPort& at) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(at.host.c_str(), std::to_string(at.port).c_str(), &hints, &found);
      error != 0)
    throw InputError(device, gai_strerror(error));
  int reason = ETIMEDOUT;
  for (const addrinfo* to = found; to != nullptr && socket_ < 0; to = to->ai_next) {
    socket_ = ::socket(to->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) continue;
    reason = ::connect(socket_, to->ai_addr, to->ai_addrlen) == 0 ? 0 : errno;
    if (reason == EINPROGRESS) {
      socklen_t size = sizeof(reason);
      reason = ETIMEDOUT;
      if (wait_for(POLLOUT, kConnectWithin)) ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &reason, &size);
    }
    if (reason != 0) close();
  }
  freeaddrinfo(found);
  if (socket_ < 0) throw InputError(device, std::strerror(reason));
  const int at_once = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof(at_once));
}

TcpStream::~TcpStream() {
  close();
}

void TcpStream::receive(std::vector<unsigned char>& bytes, std::size_t most, std::chrono::milliseconds wait) {
  if (!is_open() || !wait_for(POLLIN, wait)) return;
  const std::size_t before = bytes.size();
  bytes.resize(before + most);
  const ssize_t length = ::recv(socket_, bytes.data() + before, most, 0);
  bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
  if (length == 0 || (length < 0 && !would_wait())) close();
}

void TcpStream::send(std::span<const unsigned char> bytes, std::chrono::milliseconds wait) {
  const auto end = std::chrono::steady_clock::now() + wait;
  while (is_open() && !bytes.empty()) {
    const ssize_t length = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (length >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(length));
      continue;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (!would_wait() || left.count() <= 0 || !wait_for(POLLOUT, left)) close();
  }
}

bool TcpStream::wait_for(short events, std::chrono::milliseconds wait) const {
  pollfd wanted{socket_, events, 0};
  return ::poll(&wanted, 1, static_cast<int>(wait.count())) > 0;
}

void TcpStream::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

}  // namespace osteomill
