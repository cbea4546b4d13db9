#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <igtlImageMessage.h>
#include <igtlMessageHeader.h>
#include <igtlSensorMessage.h>
#include <igtlServerSocket.h>
#include <igtlTransformMessage.h>

#include "osteomill/device/stand_in.h"

namespace osteomill::testing_support {

/// Stands in for a tracker or for 3D Slicer: an OpenIGTLink server made of the library's own sockets, which
/// sends a tool's pose every millisecond and keeps what it is sent.
class IgtlStandIn {
 public:
  explicit IgtlStandIn(int port = 0) {
    server_ = igtl::ServerSocket::New();
    server_->CreateServer(port);
    port_ = server_->GetServerPort();
    thread_ = std::thread([this] { serve(); });
  }
  ~IgtlStandIn() {
    ends_ = true;
    thread_.join();
    server_->CloseSocket();
  }
  IgtlStandIn(const IgtlStandIn&) = delete;
  IgtlStandIn& operator=(const IgtlStandIn&) = delete;

  int port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  /// Makes a message (packed) that is sent from now on in place of the pose; none: the pose again.
  using MakeBytes = std::function<std::vector<unsigned char>()>;
  void say(MakeBytes make) {
    const std::lock_guard lock(mutex_);
    make_ = std::move(make);
  }
  std::atomic<bool> is_mute{false};
  std::atomic<bool> closes{false};
  /// The handle sweeps where this is not set.
  std::atomic<bool> is_held{false};

  /// The values of the SENSOR message of a name that came last.
  std::array<double, 3> sensor(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = sensors_.find(name);
    return found == sensors_.end() ? std::array<double, 3>{NAN, NAN, NAN} : found->second;
  }
  igtl::igtlUnit unit(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    return units_.at(name);
  }
  double most_N() const { return most_N_; }

  /// An image as it has been put together of the IMAGE messages that came.
  struct Image {
    int messages = 0;
    /// How many values the last message had.
    std::size_t last_values = 0;
    std::array<int, 3> dims{};
    std::array<float, 3> spacing_mm{};
    igtl::Matrix4x4 matrix{};
    std::vector<float> values;
  };
  Image image() const {
    const std::lock_guard lock(mutex_);
    return image_;
  }

  /// A TRANSFORM message: a quarter turn about z, at (10, -20, 30) mm.
  static std::vector<unsigned char> transform(const char* name, float x_mm = 10) {
    igtl::Matrix4x4 matrix = {{0, -1, 0, x_mm}, {1, 0, 0, -20}, {0, 0, 1, 30}, {0, 0, 0, 1}};
    const auto message = igtl::TransformMessage::New();
    message->SetDeviceName(name);
    message->SetMatrix(matrix);
    return packed(*message);
  }
  static std::vector<unsigned char> packed(igtl::MessageBase& message) {
    message.Pack();
    const auto* const begin = static_cast<const unsigned char*>(message.GetPackPointer());
    return {begin, begin + message.GetPackSize()};
  }

 private:
  void serve() {
    while (!ends_) {
      const auto client = server_->WaitForConnection(20);
      if (client.IsNull()) continue;
      closes = false;
      client->SetReceiveTimeout(20);
      std::atomic<bool> is_over{false};
      std::thread speaker([&] {
        while (!is_over && speak(*client)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      });
      while (!ends_ && !closes && client->GetConnected() && listen(*client)) {
      }
      is_over = true;
      speaker.join();
      client->CloseSocket();
      const auto force_N = sensor("OsteomillForce");
      log_of_stand_in("closed, most", most_N_.load(), "last", force_N[0], force_N[1], force_N[2]);
    }
  }

  bool speak(igtl::Socket& client) {
    if (is_mute) return true;
    MakeBytes make;
    {
      const std::lock_guard lock(mutex_);
      make = make_;
    }
    const auto bytes = make ? make() : transform("Drill", is_held ? 10 : static_cast<float>(swept_mm()));
    return client.Send(bytes.data(), static_cast<int>(bytes.size())) != 0;
  }

  // False where the other side is gone.
  bool listen(igtl::Socket& client) {
    while (!ends_ && !closes) {
      const auto header = igtl::MessageHeader::New();
      header->InitPack();
      const int length = client.Receive(header->GetPackPointer(), header->GetPackSize());
      if (length == 0) return false;
      if (length < 0) return true;
      header->Unpack();
      if (std::strcmp(header->GetDeviceType(), "IMAGE") == 0) {
        if (!take_image(client, header)) return false;
        continue;
      }
      const auto message = igtl::SensorMessage::New();
      message->SetMessageHeader(header);
      message->AllocatePack();
      client.Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
      if ((message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) == 0) return false;
      const std::lock_guard lock(mutex_);
      auto& values = sensors_[message->GetDeviceName()];
      for (unsigned n = 0; n < 3; ++n) values[n] = message->GetValue(n);
      units_[message->GetDeviceName()] = message->GetUnit();
      if (std::strcmp(message->GetDeviceName(), "OsteomillForce") == 0)
        most_N_ = std::max(most_N_.load(), std::hypot(values[0], values[1], values[2]));
    }
    return true;
  }

  bool take_image(igtl::Socket& client, const igtl::MessageHeader::Pointer& header) {
    const auto message = igtl::ImageMessage::New();
    message->SetMessageHeader(header);
    message->AllocatePack();
    client.SetReceiveTimeout(2000);
    client.Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
    client.SetReceiveTimeout(20);
    if ((message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) == 0) return false;
    const std::lock_guard lock(mutex_);
    message->GetDimensions(image_.dims.data());
    message->GetSpacing(image_.spacing_mm.data());
    message->GetMatrix(image_.matrix);
    int dims[3], first[3];
    message->GetSubVolume(dims, first);
    image_.values.resize(static_cast<std::size_t>(image_.dims[0]) * image_.dims[1] * image_.dims[2], NAN);
    image_.last_values = static_cast<std::size_t>(dims[0]) * dims[1] * dims[2];
    ++image_.messages;
    const auto* value = static_cast<const float*>(message->GetScalarPointer());
    for (int k = first[2]; k < first[2] + dims[2]; ++k) {
      for (int j = first[1]; j < first[1] + dims[1]; ++j) {
        for (int i = first[0]; i < first[0] + dims[0]; ++i)
          image_.values[(static_cast<std::size_t>(k) * image_.dims[1] + j) * image_.dims[0] + i] = *value++;
      }
    }
    return true;
  }

  igtl::ServerSocket::Pointer server_;
  int port_ = 0;
  std::atomic<bool> ends_{false};
  mutable std::mutex mutex_;
  MakeBytes make_;
  std::map<std::string, std::array<double, 3>> sensors_;
  std::map<std::string, igtl::igtlUnit> units_;
  Image image_;
  std::atomic<double> most_N_{0};
  std::thread thread_;
};

}  // namespace osteomill::testing_support
