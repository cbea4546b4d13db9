#include "osteomill/live/bone_sender.h"

#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <igtlImageMessage.h>

#include "osteomill/device/socket.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenMessages = 500ms;
constexpr auto kSendWithin = 2s;
constexpr const char* kName = "OsteomillBone";

// The protocol places an image by its middle, with x and y the other way round than W.
igtl::Matrix4x4& set_place(const GridGeometry& grid, igtl::Matrix4x4& matrix) {
  const Vec3 middle_W =
      grid.world_from_voxel(0.5 * Vec3(grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1));
  const Vec3 to_ras(-1, -1, 1);
  igtl::IdentityMatrix(matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      matrix[row][column] = static_cast<float>(to_ras[row] * grid.direction(row, column));
    matrix[row][3] = static_cast<float>(to_ras[row] * middle_W[row]);
  }
  return matrix;
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
    message->SetMatrix(set_place(grid, matrix));
    message->AllocateScalars();
    auto* density = static_cast<float*>(message->GetScalarPointer());
    for_each(box, [&](const VoxelIndex& v) { *density++ = now.grid()[v]; });
  });
  message->Pack();
  return message;
}

VoxelBox milled_box(const BoneFollower& bone, const VoxelBox& all) {
  VoxelBox box;
  for (const DensityBlock& brick : bone.touched_bricks()) {
    box.include(brick.first);
    box.include(brick.last());
  }
  return box.intersected(all);
}

void send(Socket& stream, const igtl::ImageMessage::Pointer& message) {
  stream.send_all({static_cast<const unsigned char*>(message->GetPackPointer()),
                   static_cast<std::size_t>(message->GetPackSize())},
                  kSendWithin);
}

}  // namespace

BoneSender::BoneSender(const BoneFollower& bone, const std::string& address) : bone_(bone) {
  const std::string name = "--send-bone " + address;
  std::size_t voxels = 0;
  bone.read([&](const Volume& now) { voxels = now.geometry().voxel_count(); });
  if (voxels > std::numeric_limits<int>::max() / sizeof(float))
    throw InputError(name, "the scan is larger than an OpenIGTLink image may be, 2 GiB");
  auto stream = std::make_unique<Socket>(name, host_and_port("--send-bone", address), Socket::Kind::stream);
  thread_ = std::thread([this, stream = std::move(stream)] { run(*stream); });
}

BoneSender::~BoneSender() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  end_.notify_one();
  thread_.join();
}

void BoneSender::run(Socket& stream) {
  VoxelBox all;
  bone_.read([&](const Volume& now) { all = now.geometry().all_voxels(); });
  std::uint64_t sent_version = bone_.version();
  send(stream, message_of(bone_, all));
  std::vector<unsigned char> unread(1 << 16);
  for (bool is_last = false; stream.is_open() && !is_last;) {
    {
      std::unique_lock lock(mutex_);
      is_last = end_.wait_for(lock, kBetweenMessages, [&] { return ends_; });
    }
    // What the receiver says is not wanted, but would stop it from saying more.
    stream.receive(unread);
    const std::uint64_t version = bone_.version();
    if (version == std::exchange(sent_version, version)) continue;
    if (const VoxelBox box = milled_box(bone_, all); !box.empty()) send(stream, message_of(bone_, box));
  }
  is_connected_.store(stream.is_open(), std::memory_order_relaxed);
}

}  // namespace osteomill
