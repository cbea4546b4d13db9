#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <igtlImageMessage.h>
#include <igtlMessageHeader.h>
#include <igtlServerSocket.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include "osteomill/base/row_major.h"

namespace osteomill::testing_support {

/// Replaces 3D Slicer: an OpenIGTLink server on the library's own sockets, which stores the received image
/// and tool, and closes the connection on messages that Slicer cannot read.
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

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  std::atomic<bool> closes{false};

  /// The image assembled from all received IMAGE messages.
  struct Image {
    int messages = 0;
    /// Number of values in the last message.
    std::size_t last_values = 0;
    std::array<int, 3> dims{};
    std::array<float, 3> spacing_mm{};
    igtl::Matrix4x4 matrix{};
    std::vector<float> values;
  };
  /// The last received tool.
  struct Tool {
    int messages = 0;
    std::string name;
    igtl::Matrix4x4 matrix{};
    std::string readings;
  };
  Tool tool() const {
    const std::lock_guard lock(mutex_);
    return tool_;
  }
  Image image() const {
    const std::lock_guard lock(mutex_);
    return image_;
  }

 private:
  void serve() {
    while (!ends_) {
      const auto client = server_->WaitForConnection(20);
      if (client.IsNull()) continue;
      closes = false;
      client->SetReceiveTimeout(20);
      while (!ends_ && !closes && client->GetConnected() && listen(*client)) {
      }
      client->CloseSocket();
    }
  }

  // Reads messages until stopped. Returns false if the client has disconnected.
  bool listen(igtl::Socket& client) {
    const auto header = igtl::MessageHeader::New();
    header->InitPack();
    const int length = client.Receive(header->GetPackPointer(), header->GetPackSize());
    if (length <= 0) return length < 0;
    header->Unpack();
    const std::string type = header->GetDeviceType();
    if (type == "IMAGE") return take_image(client, header);
    if (type == "TRANSFORM") return take_tool(client, header);
    if (type == "STRING") return take_readings(client, header);
    return false;
  }

  template <typename Message>
  bool take(igtl::Socket& client, const igtl::MessageHeader::Pointer& header, Message& message) {
    message->SetMessageHeader(header);
    message->AllocatePack();
    client.SetReceiveTimeout(2000);
    client.Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
    client.SetReceiveTimeout(20);
    return (message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) != 0;
  }

  bool take_tool(igtl::Socket& client, const igtl::MessageHeader::Pointer& header) {
    const auto message = igtl::TransformMessage::New();
    if (!take(client, header, message)) return false;
    const std::lock_guard lock(mutex_);
    tool_.name = message->GetDeviceName();
    message->GetMatrix(tool_.matrix);
    ++tool_.messages;
    return true;
  }

  bool take_readings(igtl::Socket& client, const igtl::MessageHeader::Pointer& header) {
    const auto message = igtl::StringMessage::New();
    if (!take(client, header, message)) return false;
    const std::lock_guard lock(mutex_);
    tool_.readings = message->GetString();
    return true;
  }

  bool take_image(igtl::Socket& client, const igtl::MessageHeader::Pointer& header) {
    const auto message = igtl::ImageMessage::New();
    if (!take(client, header, message)) return false;
    const std::lock_guard lock(mutex_);
    message->GetDimensions(image_.dims.data());
    message->GetSpacing(image_.spacing_mm.data());
    message->GetMatrix(image_.matrix);
    int dims[3], first[3];
    message->GetSubVolume(dims, first);
    image_.values.resize(osteomill::cell_count(image_.dims), NAN);
    image_.last_values = osteomill::cell_count({dims[0], dims[1], dims[2]});
    ++image_.messages;
    const auto* value = static_cast<const float*>(message->GetScalarPointer());
    for (int k = first[2]; k < first[2] + dims[2]; ++k) {
      for (int j = first[1]; j < first[1] + dims[1]; ++j) {
        for (int i = first[0]; i < first[0] + dims[0]; ++i)
          image_.values[osteomill::row_major(image_.dims, i, j, k)] = *value++;
      }
    }
    return true;
  }

  igtl::ServerSocket::Pointer server_;
  int port_ = 0;
  std::atomic<bool> ends_{false};
  mutable std::mutex mutex_;
  Image image_;
  Tool tool_;
  std::thread thread_;
};

}  // namespace osteomill::testing_support
