#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <thread>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/session/hardware.h"

#include "device/udp/udp_datagrams.h"

static std::atomic<bool> name_server_answered{false};

// Simulates a name server that does not answer.
extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* hints, addrinfo** found) {
  if (host != nullptr && std::strcmp(host, "unanswered.invalid") == 0) {
    std::this_thread::sleep_for(std::chrono::seconds(5));
    name_server_answered = true;
  }
  static const auto real = reinterpret_cast<decltype(&getaddrinfo)>(dlsym(RTLD_NEXT, "getaddrinfo"));
  return real(host, service, hints, found);
}

namespace osteomill {
namespace {

using namespace udp;

// The device's end on a free local port; tests can make it misbehave.
class StubDevice {
 public:
  StubDevice() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof(here));
    socklen_t length = sizeof(here);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&here), &length);
    address = "127.0.0.1:" + std::to_string(ntohs(here.sin_port));
    const timeval most{0, 500'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof(most));
    reply.head.kind = Kind::reply;
    std::strcpy(reply.name.data(), "Lab one");
    reply.sensed = reply.driven = 6;
    reply.max_force_N = 8;
    reply.max_torque_Nmm = 90;
  }
  ~StubDevice() { ::close(socket_); }
  StubDevice(const StubDevice&) = delete;
  StubDevice& operator=(const StubDevice&) = delete;

  // Opens it from another thread while this one answers.
  std::unique_ptr<Connection> open() {
    std::unique_ptr<Connection> opened;
    std::string fault;
    std::thread osteomill([&] {
      try {
        opened = open_udp(address);
      } catch (const InputError& error) {
        fault = error.what();
      }
    });
    Head request;
    EXPECT_TRUE(receive(request));
    EXPECT_EQ(request.kind, Kind::request);
    send(reply);
    osteomill.join();
    if (!opened) throw InputError("", fault);
    return opened;
  }
  template <typename Datagram>
  bool receive(Datagram& datagram) {
    socklen_t length = sizeof(partner_);
    return ::recvfrom(socket_, &datagram, sizeof(datagram), 0, reinterpret_cast<sockaddr*>(&partner_),
                      &length) == sizeof(datagram);
  }
  template <typename Datagram>
  void send(const Datagram& datagram, std::size_t length = sizeof(Datagram)) {
    ::sendto(socket_, &datagram, length, 0, reinterpret_cast<const sockaddr*>(&partner_), sizeof(partner_));
  }
  void send_state(std::uint32_t sequence, double x_mm) {
    State state;
    state.head.kind = Kind::state;
    state.head.sequence = sequence;
    state.position_mm = {x_mm, 2, 3};
    state.orientation_wxyz = {0.6, 0, 0.8, 0};
    state.buttons = 3;
    send(state);
  }

  std::string address;
  Reply reply;

 private:
  int socket_;
  sockaddr_in partner_{};
};

TEST(UdpDevice, ReportsCapabilitiesReadsStatesAndSendsWrenches) {
  StubDevice stub;
  const auto connection = stub.open();
  EXPECT_EQ(connection->capabilities().name, "Lab one");
  EXPECT_EQ(connection->capabilities().limits.force_N, 8);
  EXPECT_EQ(connection->capabilities().watchdog_s, kWatchdog_s);
  stub.send_state(1, 7);
  DeviceInput input;
  ASSERT_EQ(connection->read(input), ConnectionStatus::fresh);
  EXPECT_EQ(input.X_BH.position_mm, Vec3(7, 2, 3));
  EXPECT_TRUE(input.X_BH.orientation.isApprox(Quat(0.6, 0, 0.8, 0)));
  EXPECT_EQ(input.buttons, 3u);
  EXPECT_EQ(connection->read(input), ConnectionStatus::silent);
  EXPECT_EQ(connection->write({{1, 2, 3}, {4, 5, 6}}), ConnectionStatus::fresh);
  SentWrench sent;
  ASSERT_TRUE(stub.receive(sent));
  EXPECT_EQ(sent.head.kind, Kind::wrench);
  EXPECT_EQ(sent.force_N, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(sent.torque_Nmm, (std::array<double, 3>{4, 5, 6}));
}

TEST(UdpDevice, ReadsTheNewestStateAndIgnoresOvertakenOnes) {
  StubDevice stub;
  const auto connection = stub.open();
  const std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
  stub.send_state(last, 1);
  stub.send_state(0, 2);
  stub.send_state(last - 3, 3);
  DeviceInput input;
  ASSERT_EQ(connection->read(input), ConnectionStatus::fresh);
  EXPECT_EQ(input.X_BH.position_mm.x(), 2);
  stub.send_state(0, 4);
  EXPECT_EQ(connection->read(input), ConnectionStatus::silent);
  // A device that was silent may have restarted.
  std::this_thread::sleep_for(std::chrono::milliseconds(120));
  stub.send_state(last - 9, 5);
  EXPECT_EQ(connection->read(input), ConnectionStatus::fresh);
}

TEST(UdpDevice, ReportsWhyItIsNotDriven) {
  StubDevice stub;
  const auto connection = stub.open();
  State state;
  state.head.kind = Kind::state;
  DeviceInput input;
  for (const char* said : {"", "is not calibrated", "has its force off", "has its force off"}) {
    ++state.head.sequence;
    stub.send(state);
    ASSERT_EQ(connection->read(input), ConnectionStatus::fresh);
    const std::string reason = input.not_driven == nullptr ? "" : input.not_driven;
    EXPECT_EQ(reason.empty(), std::string(said).empty()) << reason;
    EXPECT_TRUE(reason.starts_with(said)) << reason;
    ++state.not_driven;
  }
}

TEST(UdpDevice, IgnoresDatagramsOutsideTheProtocol) {
  StubDevice stub;
  const auto connection = stub.open();
  DeviceInput input;
  State state;
  state.head.kind = Kind::state;
  state.head.sequence = 1;
  const auto nothing_of = [&](const State& wrong, std::size_t length) {
    stub.send(wrong, length);
    return connection->read(input) == ConnectionStatus::silent;
  };
  EXPECT_TRUE(nothing_of(state, 60));
  EXPECT_TRUE(nothing_of(state, 0));
  State other = state;
  other.head.magic[0] = 'X';
  EXPECT_TRUE(nothing_of(other, sizeof(other)));
  other = state;
  other.head.version = 2;
  EXPECT_TRUE(nothing_of(other, sizeof(other)));
  std::array<char, 4000> flood{};
  stub.send(flood);
  EXPECT_EQ(connection->read(input), ConnectionStatus::silent);
  stub.send(state);
  EXPECT_EQ(connection->read(input), ConnectionStatus::fresh);
}

std::string fault_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(UdpDevice, RefusesInvalidReplies) {
  const std::vector<std::pair<std::function<void(Reply&)>, std::string>> faults{
      {[](Reply& reply) { reply.name = {}; }, "reports no valid name"},
      {[](Reply& reply) { reply.name[1] = '\n'; }, "reports no valid name"},
      {[](Reply& reply) { reply.driven = 4; }, "6 degrees of freedom sensed and 4 driven"},
      {[](Reply& reply) { reply.max_force_N = -1; }, "negative or not finite"},
      {[](Reply& reply) { reply.max_torque_Nmm = std::numeric_limits<double>::infinity(); },
       "negative or not finite"}};
  for (const auto& [spoil, reason] : faults) {
    StubDevice stub;
    spoil(stub.reply);
    const std::string fault = fault_of([&] { stub.open(); });
    EXPECT_NE(fault.find("udp:" + stub.address + ": "), std::string::npos) << fault;
    EXPECT_NE(fault.find(reason), std::string::npos) << fault;
  }
}

TEST(UdpDevice, OneThatAnotherProgramHasIsRefused) {
  StubDevice stub;
  stub.reply.head.is_busy = 1;
  EXPECT_EQ(fault_of([&] { stub.open(); }),
            ": udp:" + stub.address + ": another program has the device in use");
}

TEST(UdpDevice, ReadsAFullLengthNameWithoutTerminator) {
  StubDevice stub;
  stub.reply.name.fill('n');
  EXPECT_EQ(stub.open()->capabilities().name, std::string(64, 'n'));
}

TEST(UdpDevice, DoesNotWaitForAnUnresponsiveNameServer) {
  EXPECT_EQ(fault_of([] { open_udp("unanswered.invalid:9"); }),
            "udp:unanswered.invalid:9: no such host is known");
  EXPECT_FALSE(name_server_answered);
}

TEST(UdpDevice, ReportsWhyItCannotBeOpenedOrFound) {
  EXPECT_EQ(fault_of([] { open_udp("nowhere"); }), "udp:nowhere: is not of the form HOST:PORT");
  EXPECT_EQ(fault_of([] { open_udp("127.0.0.1:what"); }).find("udp:127.0.0.1:what: "), 0u);
  EXPECT_EQ(fault_of([] { open_udp("no-such-host.invalid:9"); }),
            "udp:no-such-host.invalid:9: no such host is known");
  std::string address;
  {
    const StubDevice stub;
    address = stub.address;
    const FoundDevice silent = hardware_named("udp")->find(address);
    EXPECT_FALSE(silent.is_present);
    EXPECT_EQ(silent.text, "udp:" + address + ": nothing answers there");
  }
  EXPECT_EQ(hardware_named("udp")->find(address).text, "udp:" + address + ": nothing listens there");
}

}  // namespace
}  // namespace osteomill
