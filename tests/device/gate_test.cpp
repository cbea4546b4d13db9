// If a device becomes driven while its tool is inside bone, the hand feels no force until the tool is out;
// contacts after that are rendered. Tests each back end with a stand-in for its device.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <future>
#include <memory>
#include <string>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/hardware.h"
#include "osteomill/session/milling_session.h"

#include "device/udp/udp_datagrams.h"
#include "tests/scripted_device.h"
#include "tests/shapes.h"
#include "tests/support/dhd_stand_in.h"
#include "tests/support/haply_stand_in.h"
#include "tests/support/hd_stand_in.h"

namespace osteomill {
namespace {

constexpr double kTick_s = 1e-3;

// A resting device whose gate (whether it may be driven) the test opens and closes.
class Rig {
 public:
  virtual ~Rig() = default;
  virtual OpenConnection way() = 0;
  virtual void set_gate(bool is_open) = 0;
  // Returns the force on the hand.
  virtual Vec3 felt_N() const = 0;
  // Called once per tick, before the device's exchange.
  virtual void pass(double /*now_s*/) {}
};

class ScriptedRig final : public Rig {
 public:
  OpenConnection way() override { return hardware_.way(); }
  void set_gate(bool is_open) override { hardware_.input.not_driven = is_open ? nullptr : "has braked"; }
  Vec3 felt_N() const override { return hardware_.got.empty() ? Vec3::Zero() : hardware_.last().force_N; }
  void pass(double now_s) override { hardware_.now_s = now_s; }

 private:
  testing_support::ScriptedDevice hardware_;
};

template <typename State>
class LibraryRig : public Rig {
 public:
  LibraryRig(const char* variable, const char* file, const char* symbol) {
    setenv(variable, file, 1);
    library_ = dlopen(file, RTLD_NOW);
    state_ = reinterpret_cast<State* (*)()>(dlsym(library_, symbol))();
    state_->is_held = true;
  }
  ~LibraryRig() override { dlclose(library_); }

 protected:
  State* state_;

 private:
  void* library_;
};

class DhdRig : public LibraryRig<DhdStandIn> {
 public:
  DhdRig() : LibraryRig("OSTEOMILL_DHD_LIBRARY", OSTEOMILL_DHD_STAND_IN, "dhd_stand_in") {
    *state_ = {};
    state_->is_held = true;
  }
  OpenConnection way() override {
    return [] { return open_force_dimension(""); };
  }
  void set_gate(bool is_open) override { state_->status[3] = is_open ? 0 : 1; }
  Vec3 felt_N() const override {
    return state_->status[5] != 0 ? Vec3(state_->sent.data()) : Vec3(Vec3::Zero());
  }
};

// Only the device's watchdog closes the gate, and the connection reopens it by itself.
class DhdWatchdogRig final : public DhdRig {
 public:
  void set_gate(bool is_open) override {
    if (is_open) return;
    state_->status[5] = 0;
    state_->status[6] = 1;
    state_->status[14] = 3;
  }
};

class HdRig final : public LibraryRig<HdStandIn> {
 public:
  HdRig() : LibraryRig("OSTEOMILL_HD_LIBRARY", OSTEOMILL_HD_STAND_IN, "hd_stand_in") {}
  OpenConnection way() override {
    return [] { return open_touch(""); };
  }
  void set_gate(bool is_open) override { state_->calibration = is_open ? 0x5000 : 0x5002; }
  Vec3 felt_N() const override { return {state_->force[0], state_->force[1], state_->force[2]}; }
};

class HaplyRig final : public Rig {
 public:
  HaplyRig() { service_.is_held = true; }
  OpenConnection way() override {
    return [this] { return open_haply(service_.address()); };
  }
  void set_gate(bool is_open) override { service_.is_calibrated = is_open; }
  Vec3 felt_N() const override { return Vec3(service_.force_N().data()); }

 private:
  testing_support::HaplyStandIn service_;
};

class UdpRig final : public Rig {
 public:
  UdpRig() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof(here));
    socklen_t length = sizeof(here);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&here), &length);
    address_ = "127.0.0.1:" + std::to_string(ntohs(here.sin_port));
    state_.head.kind = udp::Kind::state;
    state_.orientation_wxyz = {1, 0, 0, 0};
  }
  ~UdpRig() override { ::close(socket_); }
  UdpRig(const UdpRig&) = delete;
  UdpRig& operator=(const UdpRig&) = delete;

  OpenConnection way() override {
    return [this] {
      auto opened = std::async(std::launch::async, [this] { return open_udp(address_); });
      while (opened.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) take();
      return opened.get();
    };
  }
  void set_gate(bool is_open) override { state_.not_driven = is_open ? 0 : 2; }
  Vec3 felt_N() const override { return felt_N_; }
  void pass(double /*now_s*/) override {
    take();
    ++state_.head.sequence;
    send(state_);
  }

 private:
  void take() {
    udp::SentWrench datagram;
    socklen_t length = sizeof(partner_);
    for (;;) {
      const auto size = ::recvfrom(socket_, &datagram, sizeof(datagram), 0,
                                   reinterpret_cast<sockaddr*>(&partner_), &length);
      if (size < static_cast<ssize_t>(sizeof(udp::Head))) return;
      if (datagram.head.kind == udp::Kind::wrench) felt_N_ = Vec3(datagram.force_N.data());
      if (datagram.head.kind != udp::Kind::request) continue;
      udp::Reply reply;
      reply.head.kind = udp::Kind::reply;
      std::strcpy(reply.name.data(), "rig");
      reply.sensed = reply.driven = 6;
      reply.max_force_N = 10;
      reply.max_torque_Nmm = 200;
      send(reply);
    }
  }
  template <typename Datagram>
  void send(const Datagram& datagram) {
    ::sendto(socket_, &datagram, sizeof(datagram), 0, reinterpret_cast<const sockaddr*>(&partner_),
             sizeof(partner_));
  }

  int socket_;
  std::string address_;
  udp::State state_;
  sockaddr_in partner_{};
  Vec3 felt_N_ = Vec3::Zero();
};

std::unique_ptr<Rig> rig_named(const std::string& name) {
  if (name == "dhd") return std::make_unique<DhdRig>();
  if (name == "dhd_watchdog") return std::make_unique<DhdWatchdogRig>();
  if (name == "hd") return std::make_unique<HdRig>();
  if (name == "haply") return std::make_unique<HaplyRig>();
  if (name == "udp") return std::make_unique<UdpRig>();
  return std::make_unique<ScriptedRig>();
}

using Case = std::tuple<std::string, std::string>;
class Gate : public ::testing::TestWithParam<Case> {
 protected:
  // Free space above the bone, which is below z = 0.
  static constexpr double kFree_mm = 3;

  void tick() {
    now_s_ += kTick_s;
    rig_->pass(now_s_);
    device_.exchange();
    record_ = session_.tick(device_, {.time_s = now_s_, .dt_s = kTick_s, .spindle_on = spindle_on_});
    max_N_ = std::max(max_N_, rig_->felt_N().norm());
  }
  // Some devices have their own threads and may be slow.
  template <typename Condition>
  bool becomes_true_in_time(const Condition& condition) {
    for (int n = 0; n < 3000 && !condition(); ++n) tick();
    return condition();
  }
  void move_to(double z_mm, double step_mm) {
    while (z_mm_ != z_mm) {
      z_mm_ = z_mm > z_mm_ ? std::min(z_mm, z_mm_ + step_mm) : std::max(z_mm, z_mm_ - step_mm);
      device_.put_at({{0, 0, z_mm_}, Quat::Identity()});
      tick();
    }
  }
  void press_until_it_is_felt() {
    const auto felt = [&] { return rig_->felt_N().norm() > 1; };
    for (int n = 0; n < 250 && !felt(); ++n) move_to(z_mm_ - 0.02, 0.02);
    EXPECT_TRUE(becomes_true_in_time(felt));
  }
  // Expects no force in bone and on the way out, and contact forces after that.
  void expect_contact_only_from_outside() {
    spindle_on_ = true;
    for (int n = 0; n < 150; ++n) tick();
    EXPECT_TRUE(record_.driven);
    EXPECT_EQ(record_.removed_mm3, removed_mm3_);
    spindle_on_ = false;
    move_to(kFree_mm, 0.05);
    for (int n = 0; n < 50; ++n) tick();
    EXPECT_LE(max_N_, WrenchGuard::kFreeForce_N);
    EXPECT_EQ(record_.fault, WrenchFault::none);
    press_until_it_is_felt();
  }

  std::unique_ptr<Rig> rig_ = rig_named(std::get<0>(GetParam()));
  double now_s_ = 10;
  ConnectedDevice device_{rig_->way(), [this] { return now_s_; }};
  MillingSession session_{
      std::make_shared<Volume>(testing_support::shape_volume(
          testing_support::centred_cube(60, 0.25), testing_support::plane(Vec3::Zero(), Vec3::UnitZ()))),
      {0, 1000},
      {.algorithm = algorithm_named(std::get<1>(GetParam())),
       .guard = {.limits = device_.limits_W({20, 500})}}};
  TickRecord record_;
  double z_mm_ = kFree_mm;
  double max_N_ = 0;
  double removed_mm3_ = 0;
  bool spindle_on_ = false;
};
INSTANTIATE_TEST_SUITE_P(EveryBackEnd, Gate,
                         ::testing::Combine(::testing::Values("connected", "dhd", "dhd_watchdog", "hd",
                                                              "haply", "udp"),
                                            ::testing::ValuesIn(algorithm_names())),
                         [](const auto& of) {
                           std::string name = std::get<0>(of.param) + "_" + std::get<1>(of.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Happens when a Falcon is calibrated by hand.
TEST_P(Gate, RendersContactOnlyFromOutsideWhenOpenedInsideBone) {
  if (std::get<0>(GetParam()) == "dhd_watchdog") GTEST_SKIP() << "it opens by itself before the hand sinks";
  rig_->set_gate(false);
  device_.put_at({{0, 0, 3}, Quat::Identity()});
  ASSERT_TRUE(becomes_true_in_time([&] { return is_finite(record_.X_WD); }));
  for (const double depth_mm : {0.5, -2.0}) {
    rig_->set_gate(false);
    move_to(depth_mm, 0.05);
    for (int n = 0; n < 30; ++n) tick();
    max_N_ = 0;
    removed_mm3_ = record_.removed_mm3;
    rig_->set_gate(true);
    ASSERT_TRUE(becomes_true_in_time([&] { return record_.driven; }));
    expect_contact_only_from_outside();
    move_to(kFree_mm, 0.05);
    for (int n = 0; n < 50; ++n) tick();
  }
}

// Happens when the force button is pressed twice, or the watchdog triggers.
TEST_P(Gate, RendersContactOnlyFromOutsideWhenReopenedInsideBone) {
  rig_->set_gate(true);
  ASSERT_TRUE(becomes_true_in_time([&] { return is_finite(record_.X_WD) && record_.driven; }));
  press_until_it_is_felt();
  rig_->set_gate(false);
  ASSERT_TRUE(becomes_true_in_time([&] { return !record_.driven; }));
  // The wrench ramps down in five exchanges.
  ASSERT_TRUE(becomes_true_in_time([&] { return rig_->felt_N().isZero(0); }));
  max_N_ = 0;
  removed_mm3_ = record_.removed_mm3;
  move_to(-1, 0.05);
  rig_->set_gate(true);
  ASSERT_TRUE(becomes_true_in_time([&] { return record_.driven; }));
  expect_contact_only_from_outside();
}

}  // namespace
}  // namespace osteomill
