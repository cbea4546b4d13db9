#include "osteomill/device/openigtlink/openigtlink_connection.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <numbers>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <igtlUnit.h>

#include "osteomill/device/openigtlink/igtl_stand_in.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::IgtlStandIn;
using Bytes = std::vector<unsigned char>;

class OpenIgtLink : public ::testing::Test {
 protected:
  void SetUp() override {
    server_.is_held = true;
    connection_ = open_openigtlink(server_.address());
  }
  ConnectionStatus read_until_it_is(ConnectionStatus wanted) {
    ConnectionStatus status = connection_->read(input_);
    for (int n = 0; n < 500 && status != wanted; ++n) status = connection_->read(input_);
    return status;
  }
  // What is under way has come, and then nothing usable.
  void expect_silence_from(const IgtlStandIn::MakeBytes& make, const char* what) {
    server_.say(make);
    std::this_thread::sleep_for(30ms);
    read_until_it_is(ConnectionStatus::silent);
    for (int n = 0; n < 5; ++n) EXPECT_EQ(connection_->read(input_), ConnectionStatus::silent) << what;
    server_.say({});
    EXPECT_EQ(read_until_it_is(ConnectionStatus::fresh), ConnectionStatus::fresh) << what;
  }
  static Bytes a_transform() { return IgtlStandIn::transform("Drill"); }

  IgtlStandIn server_;
  std::unique_ptr<Connection> connection_;
  DeviceInput input_;
};

TEST_F(OpenIgtLink, ReadsThePose) {
  ASSERT_EQ(read_until_it_is(ConnectionStatus::fresh), ConnectionStatus::fresh);
  EXPECT_EQ(input_.X_DH.position_mm, Vec3(10, -20, 30));
  EXPECT_NEAR((rotation_vector(input_.X_DH.orientation) - Vec3(0, 0, std::numbers::pi / 2)).norm(), 0, 1e-6);
}

TEST_F(OpenIgtLink, WritesForceAndTorqueWithTheirUnits) {
  EXPECT_EQ(connection_->write({{1, 2, 3}, {40, 50, 60}}), ConnectionStatus::fresh);
  const std::array<double, 3> force_N{1, 2, 3}, torque_Nm{0.04, 0.05, 0.06};
  for (int n = 0; n < 500 && server_.sensor("OsteomillTorque") != torque_Nm; ++n)
    std::this_thread::sleep_for(1ms);
  EXPECT_EQ(server_.sensor("OsteomillForce"), force_N);
  EXPECT_EQ(server_.sensor("OsteomillTorque"), torque_Nm);
  const auto newton = igtl::Unit::New();
  newton->Append(igtl::Unit::SI_DERIVED_NEWTON, 1);
  EXPECT_EQ(server_.unit("OsteomillForce"), newton->Pack());
  newton->Append(igtl::Unit::SI_BASE_METER, 1);
  EXPECT_EQ(server_.unit("OsteomillTorque"), newton->Pack());
}

TEST_F(OpenIgtLink, KeepsToTheFirstName) {
  ASSERT_EQ(read_until_it_is(ConnectionStatus::fresh), ConnectionStatus::fresh);
  expect_silence_from([] { return IgtlStandIn::transform("Patient"); }, "another's pose");
}

TEST_F(OpenIgtLink, AnImageGoesByUnread) {
  server_.say([] {
    const auto image = igtl::ImageMessage::New();
    image->SetDimensions(100, 100, 30);
    image->SetScalarTypeToUint8();
    image->AllocateScalars();
    Bytes bytes = IgtlStandIn::packed(*image);
    const Bytes pose = a_transform();
    bytes.insert(bytes.end(), pose.begin(), pose.end());
    return bytes;
  });
  ASSERT_EQ(read_until_it_is(ConnectionStatus::fresh), ConnectionStatus::fresh);
  EXPECT_EQ(input_.X_DH.position_mm.z(), 30);
}

TEST_F(OpenIgtLink, APoseThatIsDamagedOrNoneIsSilence) {
  expect_silence_from(
      [] {
        Bytes bytes = a_transform();
        bytes.back() ^= 1;
        return bytes;
      },
      "a wrong checksum");
  expect_silence_from(
      [] {
        igtl::Matrix4x4 matrix = {{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}};
        const auto message = igtl::TransformMessage::New();
        message->SetDeviceName("Drill");
        message->SetMatrix(matrix);
        return IgtlStandIn::packed(*message);
      },
      "a matrix that scales");
  expect_silence_from(
      [] {
        // The head alone, which says that nothing follows; of an empty body the checksum is 0.
        Bytes bytes = a_transform();
        bytes.resize(58);
        std::fill(bytes.begin() + 42, bytes.end(), 0);
        return bytes;
      },
      "a pose without a body");
}

TEST_F(OpenIgtLink, APoseThatIsNoNumberIsGivenAsSuch) {
  server_.say([] { return IgtlStandIn::transform("Drill", std::numeric_limits<float>::quiet_NaN()); });
  read_until_it_is(ConnectionStatus::fresh);
  for (int n = 0; n < 500 && is_finite(input_.X_DH); ++n) connection_->read(input_);
  EXPECT_FALSE(is_finite(input_.X_DH));
}

TEST_F(OpenIgtLink, AServerThatIsMuteIsSilentAndOneThatClosesLost) {
  ASSERT_EQ(read_until_it_is(ConnectionStatus::fresh), ConnectionStatus::fresh);
  server_.is_mute = true;
  EXPECT_EQ(read_until_it_is(ConnectionStatus::silent), ConnectionStatus::silent);
  server_.closes = true;
  EXPECT_EQ(read_until_it_is(ConnectionStatus::lost), ConnectionStatus::lost);
  EXPECT_EQ(connection_->write({}), ConnectionStatus::lost);
}

TEST_F(OpenIgtLink, WhatIsNotOpenIgtLinkIsLost) {
  server_.say([] { return Bytes(100, 'x'); });
  EXPECT_EQ(read_until_it_is(ConnectionStatus::lost), ConnectionStatus::lost);
}

TEST_F(OpenIgtLink, ClosingSendsZero) {
  connection_->write({{1, 2, 3}, Vec3::Zero()});
  connection_.reset();
  const std::array<double, 3> zero{};
  for (int n = 0; n < 500 && server_.sensor("OsteomillForce") != zero; ++n) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(server_.sensor("OsteomillForce"), zero);
}

TEST(FindOpenIgtLink, WhyThereIsNoneIsSaid) {
  EXPECT_EQ(find_openigtlink("127.0.0.1:1").text, "openigtlink:127.0.0.1:1: Connection refused");
  EXPECT_EQ(find_openigtlink("127.0.0.1:90000").text,
            "openigtlink:127.0.0.1:90000: is not of the form HOST:PORT");
}

}  // namespace
}  // namespace osteomill
