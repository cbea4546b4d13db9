#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// One end of a pipe between this process and its child. The child writes and the parent reads by the same
/// calls of `pass` in the same order.
class PipeEnd {
 public:
  enum class Direction : unsigned char { write, read };

  /// Takes ownership of the descriptor. `max_bytes` limits the size of any text or list. Throws
  /// std::runtime_error if the descriptor cannot be opened as a stream.
  PipeEnd(int descriptor, Direction direction, std::uintmax_t max_bytes);
  ~PipeEnd();
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;

  bool is_reading() const { return direction_ == Direction::read; }
  /// Writes or reads `count` bytes. Throws std::runtime_error if the other end is closed.
  void pass_bytes(void* data, std::size_t count);
  /// Writes or reads an element count; `size` is the size of an element in bytes. Throws std::runtime_error
  /// if the elements exceed `max_bytes`.
  std::size_t pass_count(std::size_t count, std::size_t size);
  /// Flushes buffered output. Throws std::runtime_error if it could not all be written.
  void flush();

 private:
  std::FILE* file_;
  Direction direction_;
  std::uintmax_t max_bytes_;
};

/// True for types that are passed as their bytes in memory.
template <typename T>
inline constexpr bool kFlat = std::is_trivially_copyable_v<T>;
template <>
inline constexpr bool kFlat<Vec3> = true;
template <>
inline constexpr bool kFlat<Mat3> = true;
template <>
inline constexpr bool kFlat<Pose> = true;
template <>
inline constexpr bool kFlat<Wrench> = true;
template <>
inline constexpr bool kFlat<TickRecord> = true;

/// Writes or reads a value: flat types as bytes, other structs member by member as tied by `members_of`.
template <typename T>
void pass(PipeEnd& pipe, T& value) {
  if constexpr (kFlat<T>) {
    pipe.pass_bytes(&value, sizeof(value));
  } else {
    std::apply([&](auto&... member) { (pass(pipe, member), ...); }, members_of(value));
  }
}

inline void pass(PipeEnd& pipe, std::string& text) {
  text.resize(pipe.pass_count(text.size(), 1));
  pipe.pass_bytes(text.data(), text.size());
}

template <typename T>
void pass(PipeEnd& pipe, std::vector<T>& list) {
  list.resize(pipe.pass_count(list.size(), sizeof(T)));
  if constexpr (kFlat<T>) {
    pipe.pass_bytes(list.data(), list.size() * sizeof(T));
  } else {
    for (T& value : list) pass(pipe, value);
  }
}

template <typename A, typename B>
void pass(PipeEnd& pipe, std::pair<A, B>& both) {
  pass(pipe, both.first);
  pass(pipe, both.second);
}

template <typename T>
void pass(PipeEnd& pipe, std::optional<T>& value) {
  bool there = value.has_value();
  pass(pipe, there);
  if (there && !value) value.emplace();
  if (there) pass(pipe, *value);
}

inline void pass(PipeEnd& pipe, std::variant<double, std::string>& value) {
  bool is_text = value.index() == 1;
  pass(pipe, is_text);
  if (pipe.is_reading() && is_text) value = std::string();
  std::visit([&](auto& held) { pass(pipe, held); }, value);
}

}  // namespace osteomill
