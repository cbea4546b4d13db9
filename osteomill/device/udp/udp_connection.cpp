#include "osteomill/device/udp/udp_connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "osteomill/device/host_and_port.h"
#include "osteomill/device/udp/udp_datagrams.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

using namespace udp;
using Clock = std::chrono::steady_clock;

constexpr int kWait_ms = 2;
constexpr int kQuestions = 10;
constexpr int kWaitForAnswer_ms = 50;
// After a silence this long the device may have begun anew, and counts from anywhere.
constexpr std::chrono::milliseconds kSilence{100};
// Whoever floods us does not hold us up.
constexpr int kMostAtOnce = 64;

class Socket {
 public:
  explicit Socket(const std::string& address) : address_(address) {
    const HostAndPort at = host_and_port("udp", address);
    addrinfo hints{};
    hints.ai_socktype = SOCK_DGRAM;
    hints.ai_flags = AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const std::string port = std::to_string(at.port);
    if (const int error = getaddrinfo(at.host.c_str(), port.c_str(), &hints, &found); error != 0)
      fail(gai_strerror(error));
    for (const addrinfo* one = found; one != nullptr && socket_ < 0; one = one->ai_next) {
      socket_ = ::socket(one->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
      // So that nobody else is heard.
      if (socket_ >= 0 && ::connect(socket_, one->ai_addr, one->ai_addrlen) != 0) close();
    }
    freeaddrinfo(found);
    if (socket_ < 0) fail(std::strerror(errno));
  }
  ~Socket() { close(); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  const std::string& address() const { return address_; }
  [[noreturn]] void fail(const std::string& reason) const { throw InputError("udp:" + address_, reason); }

  // False where there is nobody to hear it.
  template <typename Datagram>
  bool send(Datagram datagram, std::uint32_t sequence) {
    datagram.head.kind = Datagram::kKind;
    datagram.head.sequence = sequence;
    return ::send(socket_, &datagram, sizeof(datagram), 0) >= 0 || !refused();
  }
  // Until a datagram has come.
  void wait(int milliseconds) {
    pollfd wanted{socket_, POLLIN, 0};
    ::poll(&wanted, 1, milliseconds);
  }
  // One that has come and is of this kind; `gone` where there is nobody.
  template <typename Datagram>
  std::optional<Datagram> receive(bool& gone) {
    for (int n = 0; n < kMostAtOnce; ++n) {
      // A longer one is cut off, and then told by its length.
      std::array<unsigned char, 256> bytes;
      const ssize_t length = ::recv(socket_, bytes.data(), bytes.size(), 0);
      if (length < 0) {
        gone = refused();
        return std::nullopt;
      }
      Datagram datagram;
      if (length != sizeof(datagram)) continue;
      std::memcpy(&datagram, bytes.data(), sizeof(datagram));
      const Head& head = datagram.head;
      if (head.magic == kMagic && head.version == kVersion && head.kind == Datagram::kKind) return datagram;
    }
    return std::nullopt;
  }

 private:
  static bool refused() { return errno == ECONNREFUSED || errno == ENETDOWN || errno == EHOSTUNREACH; }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  std::string address_;
  int socket_ = -1;
};

struct Question {
  static constexpr Kind kKind = Kind::question;
  Head head;
};

Vec3 vector_of(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

std::array<double, 3> numbers_of(const Vec3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

bool is_limit(double value) {
  return std::isfinite(value) && value >= 0;
}

DeviceCapabilities capabilities_of(const Answer& answer, const Socket& socket) {
  DeviceCapabilities can;
  const auto end = std::find(answer.name.begin(), answer.name.end(), '\0');
  can.name.assign(answer.name.begin(), end);
  const auto printable = [](unsigned char letter) { return letter >= 0x20 && letter != 0x7f; };
  if (can.name.empty() || !std::all_of(can.name.begin(), can.name.end(), printable))
    socket.fail("the device does not say its name");
  const auto is_dof = [](std::uint32_t dof) { return dof == 3 || dof == 6; };
  if (!is_dof(answer.sensed) || !is_dof(answer.driven))
    socket.fail(
        fmt::format("the device says {} degrees of freedom sensed and {} driven, where each is 3 or 6",
                    answer.sensed, answer.driven));
  can.sensed = static_cast<int>(answer.sensed);
  can.driven = static_cast<int>(answer.driven);
  can.workspace_D_mm = vector_of(answer.workspace_mm);
  can.limits = {answer.max_force_N, answer.max_torque_Nmm};
  can.rate_Hz = answer.rate_Hz;
  if (!can.workspace_D_mm.allFinite() || !is_limit(can.limits.force_N) || !is_limit(can.limits.torque_Nmm) ||
      !is_limit(can.rate_Hz))
    socket.fail("the device says a workspace, limits or a rate that are not numbers from 0");
  return can;
}

DeviceCapabilities ask(Socket& socket) {
  bool gone = false;
  for (std::uint32_t n = 0; n < kQuestions && !gone; ++n) {
    gone = !socket.send(Question{}, n);
    socket.wait(kWaitForAnswer_ms);
    if (const auto answer = socket.receive<Answer>(gone)) return capabilities_of(*answer, socket);
  }
  socket.fail(gone ? "nothing listens there" : "nothing answers there");
}

class UdpConnection final : public Connection {
 public:
  explicit UdpConnection(const std::string& address) : socket_(address), capabilities_(ask(socket_)) {}
  ~UdpConnection() override {
    // One of them arrives.
    for (int n = 0; n < 3; ++n) write({});
  }
  UdpConnection(const UdpConnection&) = delete;
  UdpConnection& operator=(const UdpConnection&) = delete;

  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  ConnectionStatus read(DeviceInput& input) override {
    socket_.wait(kWait_ms);
    bool gone = false;
    bool fresh = false;
    for (int n = 0; n < kMostAtOnce; ++n) {
      const auto state = socket_.receive<State>(gone);
      if (!state) break;
      if (!is_newer(state->head.sequence)) continue;
      take(*state, input);
      fresh = true;
    }
    if (fresh) return ConnectionStatus::fresh;
    return gone ? ConnectionStatus::lost : ConnectionStatus::silent;
  }

  ConnectionStatus write(const Wrench& wrench_D) override {
    SentWrench sent;
    sent.force_N = numbers_of(wrench_D.force_N);
    if (capabilities_.driven == 6) sent.torque_Nmm = numbers_of(wrench_D.torque_Nmm);
    return socket_.send(sent, ++wrenches_) ? ConnectionStatus::fresh : ConnectionStatus::lost;
  }

 private:
  // Numbers go round.
  bool is_newer(std::uint32_t sequence) const {
    return !heard_ || Clock::now() - *heard_ > kSilence || static_cast<std::int32_t>(sequence - newest_) > 0;
  }

  void take(const State& state, DeviceInput& input) {
    newest_ = state.head.sequence;
    heard_ = Clock::now();
    input.X_DH.position_mm = vector_of(state.position_mm);
    const auto& [w, x, y, z] = state.orientation_wxyz;
    input.X_DH.orientation = capabilities_.sensed == 6 ? Quat(w, x, y, z) : Quat::Identity();
    input.velocity_D_mm_s = vector_of(state.velocity_mm_s);
    input.angular_velocity_D_rad_s = vector_of(state.angular_velocity_rad_s);
    input.buttons = state.buttons;
  }

  Socket socket_;
  DeviceCapabilities capabilities_;
  std::uint32_t wrenches_ = 0;
  std::uint32_t newest_ = 0;
  std::optional<Clock::time_point> heard_;
};

std::string or_default(const std::string& address) {
  return address.empty() ? kUdpAddress : address;
}

}  // namespace

std::unique_ptr<Connection> open_udp(const std::string& address) {
  return std::make_unique<UdpConnection>(or_default(address));
}

FoundDevice find_udp(const std::string& address) {
  try {
    Socket socket(or_default(address));
    return {true, fmt::format("{} at {}", ask(socket).name, socket.address())};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

}  // namespace osteomill
