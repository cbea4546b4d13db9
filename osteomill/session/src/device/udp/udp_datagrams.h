#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace osteomill::udp {

// The datagrams of docs/udp-device.md, byte for byte: little-endian, IEEE 754, no padding.
static_assert(std::endian::native == std::endian::little);

enum class Kind : std::uint16_t { request = 1, reply = 2, state = 3, wrench = 4 };

constexpr std::array<char, 4> kMagic{'O', 'M', 'I', 'L'};
constexpr std::uint16_t kVersion = 1;
constexpr double kWatchdog_s = 5e-3;

struct Head {
  std::array<char, 4> magic = kMagic;
  std::uint16_t version = kVersion;
  Kind kind{};
  std::uint32_t sequence = 0;
  /// In a reply: 1 if another partner drives the device, otherwise 0.
  std::uint32_t is_busy = 0;
};
static_assert(sizeof(Head) == 16);

struct Reply {
  static constexpr Kind kKind = Kind::reply;
  Head head;
  std::array<char, 64> name{};
  std::uint32_t sensed = 0;
  std::uint32_t driven = 0;
  double max_force_N = 0;
  double max_torque_Nmm = 0;
};
static_assert(sizeof(Reply) == 104);

struct State {
  static constexpr Kind kKind = Kind::state;
  Head head;
  std::array<double, 3> position_mm{};
  std::array<double, 4> orientation_wxyz{};
  std::uint32_t buttons = 0;
  /// 0: may be driven; 1: not calibrated; 2: force is off.
  std::uint32_t not_driven = 0;
};
static_assert(sizeof(State) == 80);

struct SentWrench {
  static constexpr Kind kKind = Kind::wrench;
  Head head;
  std::array<double, 3> force_N{};
  std::array<double, 3> torque_Nmm{};
};
static_assert(sizeof(SentWrench) == 64);

}  // namespace osteomill::udp
