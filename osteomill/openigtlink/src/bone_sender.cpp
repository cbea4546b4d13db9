#include "osteomill/openigtlink/bone_sender.h"

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <igtlImageMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/socket.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

constexpr auto kMinImageInterval = 500ms;
constexpr auto kSendTimeout = 2s;
constexpr const char* kName = "OsteomillBone";

// x and y of the protocol (RAS) are opposite to those of W.
igtl::Matrix4x4& fill_matrix(const Mat3& axes_W, const Vec3& origin_W, igtl::Matrix4x4& matrix) {
  const Vec3 to_ras(-1, -1, 1);
  igtl::IdentityMatrix(matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      matrix[row][column] = static_cast<float>(to_ras[row] * axes_W(row, column));
    matrix[row][3] = static_cast<float>(to_ras[row] * origin_W[row]);
  }
  return matrix;
}

// OpenIGTLink places an image by its centre.
Vec3 middle_W(const GridGeometry& grid) {
  return grid.world_from_voxel(0.5 * Vec3(grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1));
}

igtl::ImageMessage::Pointer message_of(const BoneFollower& bone, const VoxelBox& box) {
  auto message = igtl::ImageMessage::New();
  bone.read([&](const Volume& now) {
    const GridGeometry& grid = now.geometry();
    const auto& [ni, nj, nk] = grid.dims;
    message->SetDeviceName(kName);
    message->SetDimensions(ni, nj, nk);
    message->SetSpacing(static_cast<float>(grid.spacing_mm.x()), static_cast<float>(grid.spacing_mm.y()),
                        static_cast<float>(grid.spacing_mm.z()));
    message->SetScalarType(igtl::ImageMessage::TYPE_FLOAT32);
    message->SetEndian(igtl::ImageMessage::ENDIAN_LITTLE);
    const auto [wide, high, deep] = box.dims();
    message->SetSubVolume(wide, high, deep, box.first.i, box.first.j, box.first.k);
    igtl::Matrix4x4 matrix;
    message->SetMatrix(fill_matrix(grid.direction, middle_W(grid), matrix));
    message->AllocateScalars();
    auto* density = static_cast<float*>(message->GetScalarPointer());
    for_each(box, [&](const VoxelIndex& v) { *density++ = now.grid()[v]; });
  });
  return message;
}

void send(Socket& stream, igtl::MessageBase* message) {
  message->Pack();
  stream.send_all({static_cast<const unsigned char*>(message->GetPackPointer()),
                   static_cast<std::size_t>(message->GetPackSize())},
                  kSendTimeout);
}

void send_tool(Socket& stream, const TickRecord& now) {
  const auto place = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  place->SetDeviceName("OsteomillTool");
  place->SetMatrix(fill_matrix(now.X_WT.orientation.toRotationMatrix(), now.X_WT.position_mm, matrix));
  send(stream, place.GetPointer());
  const auto readings = igtl::StringMessage::New();
  readings->SetDeviceName("OsteomillReadings");
  std::string text = fmt::format("force {:.2f} N, torque {:.1f} N mm, removed {:.2f} mm^3, spindle {}",
                                 now.wrench.force_N.norm(), now.wrench.torque_Nmm.norm(), now.removed_mm3,
                                 now.spindle_on ? "on" : "off");
  readings->SetString(text);
  send(stream, readings.GetPointer());
}

VoxelBox milled_box(const BoneFollower& bone, const VoxelBox& all) {
  VoxelBox box;
  for (const DensityBlock& brick : bone.touched_bricks()) {
    box.include(brick.first);
    box.include(brick.last());
  }
  return box.intersected(all);
}

}  // namespace

BoneSender::BoneSender(const BoneFollower& bone, const std::string& address, double tool_rate_Hz)
    : bone_(bone), between_tools_(1 / tool_rate_Hz) {
  const std::string name = "--send-bone " + address;
  std::size_t voxels = 0;
  bone.read([&](const Volume& now) { voxels = now.geometry().voxel_count(); });
  if (voxels > std::numeric_limits<int>::max() / sizeof(float))
    throw InputError(name, "the scan is larger than an OpenIGTLink image may be, 2 GiB");
  auto stream = std::make_unique<Socket>(name, resolve_address("--send-bone", address), Socket::Kind::stream);
  thread_ =
      std::jthread([this, stream = std::move(stream)](const std::stop_token& stop) { run(stop, *stream); });
}

void BoneSender::show_tool(const TickRecord& now) {
  const std::lock_guard lock(mutex_);
  tool_ = now;
}

void BoneSender::run(const std::stop_token& stop, Socket& stream) {
  VoxelBox all;
  bone_.read([&](const Volume& now) { all = now.geometry().all_voxels(); });
  std::uint64_t sent_version = bone_.version();
  send(stream, message_of(bone_, all).GetPointer());
  auto next_bone = std::chrono::steady_clock::now() + kMinImageInterval;
  std::vector<unsigned char> unread(1 << 16);
  for (bool is_last = false; stream.is_open() && !is_last;) {
    std::optional<TickRecord> tool;
    {
      std::unique_lock lock(mutex_);
      end_.wait_for(lock, stop, between_tools_, [] { return false; });
      is_last = stop.stop_requested();
      tool = std::exchange(tool_, {});
    }
    // Read and discard the receiver's messages; unread ones would eventually block it.
    stream.receive(unread);
    if (tool) send_tool(stream, *tool);
    const auto now = std::chrono::steady_clock::now();
    if (now < next_bone && !is_last) continue;
    next_bone = now + kMinImageInterval;
    const std::uint64_t version = bone_.version();
    if (version == std::exchange(sent_version, version)) continue;
    if (const VoxelBox box = milled_box(bone_, all); !box.empty())
      send(stream, message_of(bone_, box).GetPointer());
  }
  is_connected_.store(stream.is_open(), std::memory_order_relaxed);
}

}  // namespace osteomill
