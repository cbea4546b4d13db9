#include <chrono>
#include <numbers>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/session/connected_device.h"
#include "osteomill/session/hardware.h"

#include "tests/support/haply_stand_in.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::HaplyStandIn;

class Haply : public ::testing::Test {
 protected:
  void open() {
    service_.is_held = true;
    connection_ = open_haply(service_.address());
  }
  std::string refusal() {
    try {
      open();
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
  // Writes and reads like the device's thread until the status is `wanted`, at most 5 s.
  ConnectionStatus go_on_until(ConnectionStatus wanted, DeviceInput& input) {
    const auto until = std::chrono::steady_clock::now() + 5s;
    ConnectionStatus status = connection_->read(input);
    while (status != wanted && std::chrono::steady_clock::now() < until) {
      connection_->write(wrench_);
      status = connection_->read(input);
    }
    return status;
  }
  Vec3 force_N() const { return Vec3(service_.force_N().data()); }
  void await_force(const Vec3& wanted_N) {
    DeviceInput input;
    for (int n = 0; n < 300 && force_N() != wanted_N; ++n) go_on_until(ConnectionStatus::fresh, input);
    EXPECT_EQ(force_N(), wanted_N);
  }

  HaplyStandIn service_;
  std::unique_ptr<Connection> connection_;
  Wrench wrench_;
};

TEST_F(Haply, SaysWhatItCan) {
  open();
  const DeviceCapabilities& can = connection_->capabilities();
  EXPECT_EQ(can.name, "Haply Inverse3 049D");
  EXPECT_EQ(can.sensed, 6);
  EXPECT_EQ(can.driven, 3);
  // B: y away from the operator, z up.
  EXPECT_TRUE((can.R_VB * Vec3::UnitY()).isApprox(-Vec3::UnitZ()));
  EXPECT_TRUE((can.R_VB * Vec3::UnitZ()).isApprox(Vec3::UnitY()));
}

TEST_F(Haply, RefusesAMinverse) {
  service_.type = "minverse";
  EXPECT_EQ(refusal(), "haply:" + service_.address() + ": the service has no Inverse3");
}

TEST_F(Haply, FindsAnInverse3ListedAfterAMinverse) {
  service_.has_minverse_first = true;
  open();
  EXPECT_EQ(connection_->capabilities().name, "Haply Inverse3 049D");
  DeviceInput input;
  EXPECT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
}

TEST_F(Haply, FindingItSendsNothing) {
  EXPECT_EQ(hardware_named("haply")->find(service_.address()).text, "Haply Inverse3 049D");
  EXPECT_TRUE(service_.heard().empty()) << "the program that drives it would feel it";
}

TEST_F(Haply, SendsItsProfileOnlyWithTheFirstCommand) {
  open();
  DeviceInput input;
  for (int n = 0; n < 3; ++n) go_on_until(ConnectionStatus::fresh, input);
  const auto heard = service_.heard();
  ASSERT_GE(heard.size(), 2u);
  EXPECT_NE(heard[0].find(R"("session":{"configure":{"profile":{"name":"osteomill"}}})"), std::string::npos);
  EXPECT_EQ(heard[1].find("session"), std::string::npos);
}

TEST_F(Haply, IsDrivenWhenCalibratedAndGripIsAwake) {
  service_.is_calibrated = false;
  open();
  DeviceInput input;
  const auto why_not = [&] {
    for (int n = 0; n < 3; ++n) go_on_until(ConnectionStatus::fresh, input);
    return std::string(input.not_driven == nullptr ? "" : input.not_driven);
  };
  EXPECT_EQ(why_not().substr(0, 17), "is not calibrated");
  service_.is_calibrated = true;
  EXPECT_EQ(why_not(), "");
  service_.is_awake = false;
  EXPECT_EQ(why_not().substr(0, 22), "has a grip that sleeps");
}

TEST_F(Haply, ReportsARemarkWhenTheServiceAltersForces) {
  open();
  wrench_.force_N = {0, 0, 3};
  DeviceInput input;
  for (int n = 0; n < 50; ++n) go_on_until(ConnectionStatus::fresh, input);
  EXPECT_EQ(input.remark, nullptr);
  service_.force_scale = 0.3;
  for (int n = 0; n < 150; ++n) go_on_until(ConnectionStatus::fresh, input);
  ASSERT_NE(input.remark, nullptr);
  EXPECT_EQ(std::string(input.remark).substr(0, 18), "gives other forces");
}

// Consecutive forces received by a slow service.
TEST_F(Haply, LimitsForceStepsToASlowService) {
  service_.is_held = true;
  for (const int delay_ms : {2, 3}) {
    service_.delay_ms = delay_ms;
    const std::size_t before = service_.heard().size();
    {
      ConnectedDevice device([this] { return open_haply(service_.address()); });
      device.start();
      const auto end = std::chrono::steady_clock::now() + 250ms;
      for (int n = 0; std::chrono::steady_clock::now() < end; ++n) {
        device.read_pose();
        device.write_wrench({{0, n % 60 < 30 ? 9.0 : -9.0, 0}, Vec3::Zero()});
        std::this_thread::sleep_for(1ms);
      }
    }
    const auto forces = service_.forces();
    double max_N = 0;
    double largest_N = 0;
    for (std::size_t n = before + 1; n < forces.size(); ++n) {
      const Vec3 now(forces[n].data());
      largest_N = std::max(largest_N, (now - Vec3(forces[n - 1].data())).norm());
      max_N = std::max(max_N, now.norm());
    }
    EXPECT_GT(max_N, 5) << delay_ms;
    EXPECT_LE(largest_N, 4 + 1e-6) << delay_ms;
  }
}

TEST_F(Haply, RefusesToStartWithoutAPose) {
  service_.is_mute = true;
  ConnectedDevice device([this] { return open_haply(service_.address()); });
  try {
    device.start();
    FAIL() << "it gave no pose";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("has given no pose for"), std::string::npos) << error.what();
  }
}

TEST_F(Haply, ConvertsMetresToMillimetresAndReadsTheGrip) {
  open();
  DeviceInput input;
  ASSERT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  EXPECT_TRUE(input.X_BH.position_mm.isApprox(Vec3(10, -20, 30)));
  EXPECT_NEAR((rotation_vector(input.X_BH.orientation) - Vec3(0, 0, std::numbers::pi / 2)).norm(), 0, 1e-12);
  EXPECT_EQ(input.buttons, 5u);
}

TEST_F(Haply, ReadsOneButtonFromAWiredGrip) {
  service_.grip = "verse_grip";
  open();
  DeviceInput input;
  ASSERT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  EXPECT_EQ(input.buttons, 1u);
}

TEST_F(Haply, SensesPositionOnlyWithoutAGrip) {
  service_.grip = nullptr;
  open();
  EXPECT_EQ(connection_->capabilities().sensed, 3);
  DeviceInput input;
  ASSERT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  EXPECT_TRUE(input.X_BH.orientation.isApprox(Quat::Identity()));
}

TEST_F(Haply, SendsForceAsVectorToCurrentServices) {
  wrench_.force_N = {1, 2, 3};
  open();
  await_force({1, 2, 3});
  EXPECT_NE(service_.heard().back().find("\"vector\""), std::string::npos);
}

TEST_F(Haply, SendsForceAsValuesToOldServices) {
  service_.is_3_5 = false;
  wrench_.force_N = {1, 2, 3};
  open();
  await_force({1, 2, 3});
  EXPECT_NE(service_.heard().back().find("\"values\""), std::string::npos);
}

TEST_F(Haply, ClosingSendsZero) {
  wrench_.force_N = {1, 2, 3};
  open();
  await_force({1, 2, 3});
  connection_.reset();
  for (int n = 0; n < 100 && force_N() != Vec3::Zero(); ++n) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(force_N(), Vec3::Zero());
}

TEST_F(Haply, TreatsInvalidStatesAsSilence) {
  open();
  DeviceInput input;
  ASSERT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  const std::string state = service_.state().dump();
  std::string without_position = state;
  without_position.replace(state.find("cursor_position"), 15, "cursor_preposition");
  std::string text_for_number = state;
  text_for_number.replace(state.find("-0.02"), 5, "\"far\"");
  const std::string bad[] = {"{",
                             "[]",
                             "3",
                             "\xff\xfe",
                             "{}",
                             R"({"inverse3":[]})",
                             R"({"inverse3":[3]})",
                             R"({"inverse3":[{"device_id":"049D"}]})",
                             R"({"inverse3":[{"device_id":"049D","state":[]}]})",
                             state.substr(0, state.size() / 2),
                             without_position,
                             text_for_number,
                             std::string(200000, '['),
                             std::string(100000, '{') + std::string(100000, '}')};
  for (const std::string& text : bad) {
    service_.say(text);
    go_on_until(ConnectionStatus::silent, input);
    for (int n = 0; n < 5; ++n) {
      connection_->write({});
      EXPECT_EQ(connection_->read(input), ConnectionStatus::silent) << text.substr(0, 80);
    }
  }
  service_.say("");
  EXPECT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
}

TEST_F(Haply, IsLostAfterAMessageThatIsTooLong) {
  open();
  service_.say(std::string(1 << 20, ' '));
  DeviceInput input;
  EXPECT_EQ(go_on_until(ConnectionStatus::lost, input), ConnectionStatus::lost);
}

TEST_F(Haply, IsSilentThenLostWhenServiceIsMuteAndLostOnClose) {
  open();
  DeviceInput input;
  ASSERT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  service_.is_mute = true;
  go_on_until(ConnectionStatus::silent, input);
  const std::size_t before = service_.heard().size();
  EXPECT_EQ(go_on_until(ConnectionStatus::lost, input), ConnectionStatus::lost);
  EXPECT_LE(service_.heard().size(), before + 1);
  service_.is_mute = false;
  open();
  ASSERT_EQ(go_on_until(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  service_.closes = true;
  EXPECT_EQ(go_on_until(ConnectionStatus::lost, input), ConnectionStatus::lost);
  EXPECT_EQ(connection_->write({}), ConnectionStatus::lost);
}

// However slow the service is, no outdated wrenches queue up.
TEST_F(Haply, KeepsOneCommandInFlightAndReportsHighLatency) {
  service_.delay_ms = 30;
  open();
  DeviceInput input;
  std::size_t answered = 0;
  for (const auto end = std::chrono::steady_clock::now() + 1s; std::chrono::steady_clock::now() < end;) {
    answered += connection_->read(input) == ConnectionStatus::fresh ? 1 : 0;
    connection_->write({});
    ASSERT_LE(service_.heard().size(), answered + 1);
  }
  ASSERT_GT(answered, 3u);
  ASSERT_NE(input.remark, nullptr);
  EXPECT_EQ(std::string(input.remark).substr(0, 14), "answers after ");
  // The remark disappears once it answers quickly.
  service_.delay_ms = 0;
  for (int n = 0; n < 2000 && input.remark != nullptr; ++n) go_on_until(ConnectionStatus::fresh, input);
  EXPECT_EQ(input.remark, nullptr);
}

TEST_F(Haply, OneThatAnotherProgramHasIsRefused) {
  service_.is_in_use = true;
  EXPECT_EQ(refusal(), "haply:" + service_.address() + ": another program has the Inverse3 049D in use");
  EXPECT_EQ(hardware_named("haply")->find(service_.address()).text,
            "Haply Inverse3 049D, in use by another program");
  EXPECT_TRUE(service_.heard().empty()) << "the program that drives it would feel it";
}

TEST_F(Haply, WhyThereIsNoneIsSaid) {
  EXPECT_EQ(hardware_named("haply")->find(service_.address()).text, "Haply Inverse3 049D");
  service_.has_device = false;
  EXPECT_EQ(refusal(), "haply:" + service_.address() + ": the service has no Inverse3");
  EXPECT_EQ(hardware_named("haply")->find("127.0.0.1:1").text, "haply:127.0.0.1:1: nothing answers there");
  EXPECT_EQ(hardware_named("haply")->find("nowhere").text, "haply:nowhere: is not of the form HOST:PORT");
}

}  // namespace
}  // namespace osteomill
