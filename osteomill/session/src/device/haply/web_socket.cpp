#include "device/haply/web_socket.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <utility>
#include <vector>

#include <libwebsockets.h>
#include <poll.h>

#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

constexpr std::chrono::milliseconds kConnectWithin{400};

}  // namespace

struct WebSocket::Impl {
  explicit Impl(std::size_t most) : max_bytes(most) {
    lws_set_log_level(0, nullptr);
    lws_context_creation_info info{};
    info.port = CONTEXT_PORT_NO_LISTEN;
    info.protocols = protocols.data();
    info.user = this;
    context = lws_create_context(&info);
  }
  ~Impl() {
    if (context != nullptr) lws_context_destroy(context);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  static int on_event(lws* socket, lws_callback_reasons reason, void* /*user*/, void* data, size_t length) {
    auto* const self = static_cast<Impl*>(lws_context_user(lws_get_context(socket)));
    switch (reason) {
      case LWS_CALLBACK_CLIENT_ESTABLISHED:
        self->is_open = true;
        return 0;
      case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
      case LWS_CALLBACK_CLIENT_CLOSED:
        self->is_open = false;
        self->socket = nullptr;
        return 0;
      case LWS_CALLBACK_CLIENT_RECEIVE:
        return self->take(static_cast<const char*>(data), length) ? 0 : -1;
      case LWS_CALLBACK_CLIENT_WRITEABLE:
        return self->write() ? 0 : -1;
      default:
        return 0;
    }
  }

  bool take(const char* data, std::size_t length) {
    if (partial_message.size() + length > max_bytes) return false;
    partial_message.append(data, length);
    if (lws_is_final_fragment(socket) != 0 && lws_remaining_packet_payload(socket) == 0)
      newest = std::exchange(partial_message, {});
    return true;
  }

  bool write() {
    if (!outgoing) return true;
    // The library writes its header in front of the payload.
    std::vector<unsigned char> packet(LWS_PRE + outgoing->size());
    std::copy(outgoing->begin(), outgoing->end(), packet.begin() + LWS_PRE);
    const std::size_t length = outgoing->size();
    outgoing.reset();
    return lws_write(socket, packet.data() + LWS_PRE, length, LWS_WRITE_TEXT) >= static_cast<int>(length);
  }

  // Waits for input or the timeout. Does not use the library's own wait, which may sleep for half a minute if
  // its timer fires before it goes to sleep.
  void serve(std::chrono::microseconds wait) {
    const std::int64_t wait_us = std::max<std::int64_t>(wait.count(), 0);
    const timespec time{wait_us / 1'000'000, wait_us % 1'000'000 * 1000};
    pollfd wanted{socket == nullptr ? -1 : lws_get_socket_fd(socket), POLLIN, 0};
    ::ppoll(&wanted, 1, &time, nullptr);
    constexpr int kAtOnce = -1;
    lws_service(context, kAtOnce);
  }

  const std::array<lws_protocols, 2> protocols{
      {{"", &on_event, 0, 64 * 1024, 0, nullptr, 0}, {nullptr, nullptr, 0, 0, 0, nullptr, 0}}};
  std::size_t max_bytes;
  lws_context* context = nullptr;
  lws* socket = nullptr;
  bool is_open = false;
  std::string partial_message;
  std::optional<std::string> newest;
  std::optional<std::string> outgoing;
};

WebSocket::WebSocket(const std::string& device, const std::string& host, int port, std::size_t max_bytes)
    : impl_(std::make_unique<Impl>(max_bytes)) {
  if (impl_->context == nullptr) throw InputError(device, "cannot create a WebSocket");
  lws_client_connect_info to{};
  to.context = impl_->context;
  to.address = to.host = to.origin = host.c_str();
  to.port = port;
  to.path = "/";
  to.pwsi = &impl_->socket;
  to.ietf_version_or_minus_one = -1;
  lws_client_connect_via_info(&to);
  const auto end = std::chrono::steady_clock::now() + kConnectWithin;
  while (!impl_->is_open && impl_->socket != nullptr && std::chrono::steady_clock::now() < end) {
    impl_->serve(std::chrono::milliseconds(1));
  }
  if (!impl_->is_open) throw InputError(device, "nothing answers there");
}

WebSocket::~WebSocket() = default;

bool WebSocket::is_open() const {
  return impl_->is_open;
}

std::optional<std::string> WebSocket::receive(std::chrono::microseconds wait) {
  const auto end = std::chrono::steady_clock::now() + wait;
  while (is_open() && !impl_->newest) {
    const auto left =
        std::chrono::duration_cast<std::chrono::microseconds>(end - std::chrono::steady_clock::now());
    impl_->serve(left);
    if (left.count() <= 0) break;
  }
  return std::exchange(impl_->newest, {});
}

bool WebSocket::send(std::string text) {
  if (!is_open()) return false;
  impl_->outgoing = std::move(text);
  lws_callback_on_writable(impl_->socket);
  impl_->serve({});
  return !impl_->outgoing;
}

}  // namespace osteomill
