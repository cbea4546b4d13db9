#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/positive.h"
#include "osteomill/base/socket.h"
#include "osteomill/session/hardware.h"

#include "device/udp/udp_datagrams.h"

namespace osteomill {

namespace {

using namespace udp;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr const char* kDefaultAddress = "127.0.0.1:47117";
constexpr auto kWait = 2ms;
constexpr int kRequests = 10;
constexpr auto kReplyTimeout = 50ms;
// After a longer silence the device may have restarted, so any sequence number is accepted.
constexpr auto kSilence = 100ms;
constexpr std::array<const char*, 3> kWhyNotDriven{nullptr,
                                                   "is not calibrated: calibrate it as its vendor says",
                                                   "has its force off: switch it on as its vendor says"};
// Maximum number of datagrams per read, so that a flood does not block the thread.
constexpr int kMaxDatagrams = 64;

struct Request {
  static constexpr Kind kKind = Kind::request;
  Head head;
};

// Returns whether the datagram was sent.
template <typename Datagram>
bool send(Socket& socket, Datagram datagram, std::uint32_t sequence) {
  datagram.head.kind = Datagram::kKind;
  datagram.head.sequence = sequence;
  return socket.send({reinterpret_cast<const unsigned char*>(&datagram), sizeof(datagram)}) > 0;
}

// Returns the next received datagram of this kind, skipping others.
template <typename Datagram>
std::optional<Datagram> receive(Socket& socket) {
  for (int n = 0; n < kMaxDatagrams; ++n) {
    // Longer datagrams are truncated; their length then does not match.
    std::array<unsigned char, 256> bytes;
    const std::optional<std::size_t> length = socket.receive(bytes);
    if (!length) return std::nullopt;
    Datagram datagram;
    if (*length != sizeof(datagram)) continue;
    std::memcpy(&datagram, bytes.data(), sizeof(datagram));
    const Head& head = datagram.head;
    if (head.magic == kMagic && head.version == kVersion && head.kind == Datagram::kKind) return datagram;
  }
  return std::nullopt;
}

DeviceCapabilities capabilities_of(const Reply& reply, const std::string& device) {
  DeviceCapabilities can;
  const auto end = std::find(reply.name.begin(), reply.name.end(), '\0');
  can.name.assign(reply.name.begin(), end);
  const auto printable = [](unsigned char letter) { return letter >= 0x20 && letter != 0x7f; };
  if (can.name.empty() || !std::all_of(can.name.begin(), can.name.end(), printable))
    throw InputError(device, "the device reports no valid name");
  const auto is_dof = [](std::uint32_t dof) { return dof == 3 || dof == 6; };
  if (!is_dof(reply.sensed) || !is_dof(reply.driven))
    throw InputError(
        device,
        fmt::format("the device reports {} degrees of freedom sensed and {} driven; each must be 3 or 6",
                    reply.sensed, reply.driven));
  can.sensed = static_cast<int>(reply.sensed);
  can.driven = static_cast<int>(reply.driven);
  can.limits = {reply.max_force_N, reply.max_torque_Nmm};
  can.watchdog_s = kWatchdog_s;
  if (!is_not_negative(can.limits.force_N) || !is_not_negative(can.limits.torque_Nmm))
    throw InputError(device, "the device reports limits that are negative or not finite");
  return can;
}

// A device that has answered at HOST:PORT.
struct Partner {
  explicit Partner(const std::string& address)
      : socket("udp:" + address, resolve_address("udp", address), Socket::Kind::datagrams) {
    for (std::uint32_t n = 0; n < kRequests && socket.is_open(); ++n) {
      send(socket, Request{}, n);
      socket.wait_to_receive(kReplyTimeout);
      if (const auto reply = receive<Reply>(socket)) {
        capabilities = capabilities_of(*reply, "udp:" + address);
        is_busy = reply->head.is_busy != 0;
        if (!is_busy) return;
        // A killed program keeps the device for another moment; ask again.
        std::this_thread::sleep_for(kReplyTimeout);
      }
    }
    if (is_busy) return;
    throw InputError("udp:" + address, socket.is_open() ? "nothing answers there" : "nothing listens there");
  }

  Socket socket;
  DeviceCapabilities capabilities;
  // In use by another program.
  bool is_busy = false;
};

class UdpConnection final : public Connection {
 public:
  explicit UdpConnection(const std::string& address) : partner_(address) {
    if (partner_.is_busy) throw InputError("udp:" + address, "another program has the device in use");
  }
  ~UdpConnection() override {
    // Datagrams may be lost; send zero three times.
    for (int n = 0; n < 3; ++n) write({});
  }

  const DeviceCapabilities& capabilities() const override { return partner_.capabilities; }

  ConnectionStatus read(DeviceInput& input) override {
    partner_.socket.wait_to_receive(kWait);
    bool fresh = false;
    for (int n = 0; n < kMaxDatagrams; ++n) {
      const auto state = receive<State>(partner_.socket);
      if (!state) break;
      if (!is_newer(state->head.sequence)) continue;
      take(*state, input);
      fresh = true;
    }
    if (fresh) return ConnectionStatus::fresh;
    return partner_.socket.is_open() ? ConnectionStatus::silent : ConnectionStatus::lost;
  }

  ConnectionStatus write(const Wrench& wrench_B) override {
    SentWrench sent;
    Vec3::Map(sent.force_N.data()) = wrench_B.force_N;
    if (partner_.capabilities.driven == 6) Vec3::Map(sent.torque_Nmm.data()) = wrench_B.torque_Nmm;
    const bool is_sent = send(partner_.socket, sent, ++wrenches_);
    if (!partner_.socket.is_open()) return ConnectionStatus::lost;
    return is_sent ? ConnectionStatus::fresh : ConnectionStatus::silent;
  }

 private:
  // Sequence numbers wrap around.
  bool is_newer(std::uint32_t sequence) const {
    return !last_state_time_ || Clock::now() - *last_state_time_ > kSilence ||
           static_cast<std::int32_t>(sequence - newest_) > 0;
  }

  void take(const State& state, DeviceInput& input) {
    newest_ = state.head.sequence;
    last_state_time_ = Clock::now();
    input.X_BH.position_mm = Vec3::Map(state.position_mm.data());
    const auto& [w, x, y, z] = state.orientation_wxyz;
    input.X_BH.orientation = partner_.capabilities.sensed == 6 ? Quat(w, x, y, z) : Quat::Identity();
    input.buttons = state.buttons;
    input.not_driven = kWhyNotDriven[std::min<std::size_t>(state.not_driven, kWhyNotDriven.size() - 1)];
  }

  Partner partner_;
  std::uint32_t wrenches_ = 0;
  std::uint32_t newest_ = 0;
  std::optional<Clock::time_point> last_state_time_;
};

std::string or_default(const std::string& address) {
  return address.empty() ? kDefaultAddress : address;
}

}  // namespace

std::unique_ptr<Connection> open_udp(const std::string& address) {
  return std::make_unique<UdpConnection>(or_default(address));
}

std::string probe_udp(const std::string& address) {
  const std::string at = or_default(address);
  const Partner partner(at);
  return fmt::format("{} at {}{}", partner.capabilities.name, at,
                     partner.is_busy ? ", in use by another program" : "");
}

}  // namespace osteomill
