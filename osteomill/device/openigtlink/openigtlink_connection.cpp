#include "osteomill/device/openigtlink/openigtlink_connection.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include <fmt/core.h>
#include <igtlSensorMessage.h>
#include <igtlUnit.h>
#include <igtl_header.h>
#include <igtl_transform.h>
#include <igtl_util.h>

#include "osteomill/device/openigtlink/tcp_stream.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

constexpr double kMmPerM = 1000;
constexpr auto kWait = 2ms;
constexpr std::size_t kMostAtOnce = 1 << 16;
// What another message (an image, say) has in it goes by unread; a TRANSFORM is 48 bytes and what later
// versions add.
constexpr std::size_t kMostOfTransform = 1 << 12;

using Matrix = std::array<float, 12>;

// Messages, one after the other, from bytes as they come.
class MessageReader {
 public:
  // The matrix of the next TRANSFORM of the wanted name (any where that is empty, which is then the wanted
  // one): three axes and the position, three numbers each.
  std::optional<Matrix> next(std::string& wanted) {
    while (skip_rest() && buffer_.size() >= IGTL_HEADER_SIZE) {
      igtl_header header;
      std::memcpy(&header, buffer_.data(), sizeof(header));
      igtl_header_convert_byte_order(&header);
      is_broken_ = header.version < 1 || header.version > 3;
      if (is_broken_) return std::nullopt;
      const bool is_transform = std::strncmp(header.name, "TRANSFORM", sizeof(header.name)) == 0;
      const std::string name(header.device_name, strnlen(header.device_name, sizeof(header.device_name)));
      if (!is_transform || header.body_size > kMostOfTransform || !(wanted.empty() || wanted == name)) {
        drop(IGTL_HEADER_SIZE);
        to_skip_ = header.body_size;
        continue;
      }
      const std::size_t length = IGTL_HEADER_SIZE + header.body_size;
      if (buffer_.size() < length) return std::nullopt;
      const std::optional<Matrix> matrix =
          matrix_in(header, std::span(buffer_).first(length).subspan(IGTL_HEADER_SIZE));
      drop(length);
      if (!matrix) continue;
      wanted = name;
      return matrix;
    }
    return std::nullopt;
  }
  std::vector<unsigned char>& buffer() { return buffer_; }
  bool is_broken() const { return is_broken_; }

 private:
  static std::optional<Matrix> matrix_in(const igtl_header& header, std::span<unsigned char> body) {
    if (crc64(body.data(), body.size(), 0) != header.crc) return std::nullopt;
    // From version 2 on a further head comes first, which begins with its length.
    const std::size_t at = header.version < 2 ? 0 : body.size() < 2 ? body.size() : body[0] << 8 | body[1];
    Matrix matrix;
    if (body.size() < at || body.size() - at < sizeof(matrix)) return std::nullopt;
    std::memcpy(matrix.data(), body.data() + at, sizeof(matrix));
    igtl_transform_convert_byte_order(matrix.data());
    return matrix;
  }
  void drop(std::size_t length) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(length));
  }
  // True when nothing is left of a message that goes by unread.
  bool skip_rest() {
    const std::size_t here = std::min<std::uint64_t>(to_skip_, buffer_.size());
    drop(here);
    to_skip_ -= here;
    return to_skip_ == 0;
  }

  std::vector<unsigned char> buffer_;
  std::uint64_t to_skip_ = 0;
  bool is_broken_ = false;
};

// Nothing where it is neither a rotation nor unknown, which is a pose that is not finite.
std::optional<Pose> pose_of(const Matrix& matrix) {
  const auto X_DH = Eigen::Map<const Eigen::Matrix<float, 3, 4>>(matrix.data()).cast<double>().eval();
  const Mat3 R_DH = X_DH.leftCols<3>();
  constexpr double kMuchOff = 1e-2;
  if (R_DH.allFinite() &&
      ((R_DH.transpose() * R_DH - Mat3::Identity()).norm() > kMuchOff || R_DH.determinant() < 0))
    return std::nullopt;
  return Pose{X_DH.col(3), Quat(R_DH).normalized()};
}

std::string name_of(const HostAndPort& at) {
  return fmt::format("openigtlink:{}:{}", at.host, at.port);
}

class OpenIgtLinkConnection final : public Connection {
 public:
  explicit OpenIgtLinkConnection(const HostAndPort& at) : stream_(name_of(at), at) {
    capabilities_.name = fmt::format("OpenIGTLink {}:{}", at.host, at.port);
  }
  ~OpenIgtLinkConnection() override { write({}); }
  OpenIgtLinkConnection(const OpenIgtLinkConnection&) = delete;
  OpenIgtLinkConnection& operator=(const OpenIgtLinkConnection&) = delete;

  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  ConnectionStatus read(DeviceInput& input) override {
    stream_.receive(reader_.buffer(), kMostAtOnce, kWait);
    bool is_fresh = false;
    while (const std::optional<Matrix> matrix = reader_.next(transform_)) {
      const std::optional<Pose> X_DH = pose_of(*matrix);
      if (!X_DH) continue;
      input = {};
      input.X_DH = *X_DH;
      is_fresh = true;
    }
    if (is_fresh) return ConnectionStatus::fresh;
    return stream_.is_open() && !reader_.is_broken() ? ConnectionStatus::silent : ConnectionStatus::lost;
  }

  ConnectionStatus write(const Wrench& wrench_D) override {
    send("OsteomillForce", wrench_D.force_N, igtl::Unit::SI_BASE_NONE);
    send("OsteomillTorque", wrench_D.torque_Nmm / kMmPerM, igtl::Unit::SI_BASE_METER);
    return stream_.is_open() ? ConnectionStatus::fresh : ConnectionStatus::lost;
  }

 private:
  // In newton, times a metre where it is a torque.
  void send(const char* name, const Vec3& values, unsigned char times) {
    igtl::Unit::Pointer unit = igtl::Unit::New();
    unit->Append(igtl::Unit::SI_DERIVED_NEWTON, 1);
    if (times != igtl::Unit::SI_BASE_NONE) unit->Append(times, 1);
    const auto message = igtl::SensorMessage::New();
    message->SetDeviceName(name);
    message->SetLength(3);
    message->SetUnit(unit->Pack());
    for (unsigned n = 0; n < 3; ++n) message->SetValue(n, values[n]);
    message->Pack();
    stream_.send({static_cast<const unsigned char*>(message->GetPackPointer()),
                  static_cast<std::size_t>(message->GetPackSize())},
                 kWait);
  }

  TcpStream stream_;
  DeviceCapabilities capabilities_;
  MessageReader reader_;
  std::string transform_;
};

HostAndPort place_of(const std::string& address) {
  return host_and_port("openigtlink", address.empty() ? kOpenIgtLinkAddress : address);
}

}  // namespace

std::unique_ptr<Connection> open_openigtlink(const std::string& address) {
  return std::make_unique<OpenIgtLinkConnection>(place_of(address));
}

// What answers need not speak OpenIGTLink: a server says nothing until it has something to say.
FoundDevice find_openigtlink(const std::string& address) {
  try {
    const HostAndPort at = place_of(address);
    const TcpStream stream(name_of(at), at);
    return {true, fmt::format("a server at {}:{}", at.host, at.port)};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

}  // namespace osteomill
