#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace osteomill {

/// Memory layout of a 3D array of floats: rows of `row_length` values start `row_stride` floats apart, slices
/// of `slice_rows` rows `slice_stride` floats apart. The padding between them is 0 and unused.
struct RowLayout {
  std::size_t row_length = 0;
  std::size_t row_stride = 0;
  std::size_t slice_rows = 0;
  std::size_t slice_stride = 0;
  std::size_t slices = 0;

  /// Pads rows and slices so that every row starts on a cache line and neighbouring rows, along j and k, map
  /// to different cache sets. Without padding, the rows of a scan 512 voxels wide share so few sets that the
  /// burr's neighbourhood, a tenth of the cache's size, keeps evicting itself. Does not pad if rows or slices
  /// have fewer than 64 entries, because there the padding would take most of the memory. Needs at most 1.6
  /// times the memory of the values.
  static RowLayout with_padding(std::size_t row_length, std::size_t slice_rows, std::size_t slices);

  std::size_t size() const { return slice_stride * slices; }
};

/// Array of floats with copy-on-write pages (4 KiB): a copy takes memory only for the pages written in it or
/// in its source. Reading is as fast as with a plain array.
///
/// The first write to a page makes the system copy it, which takes microseconds; if the writing thread cannot
/// wait, another thread calls `prefault` beforehand. One thread writes; no thread may copy at the same time.
class CopyOnWriteFloats {
 public:
  CopyOnWriteFloats() = default;
  /// Copies the rows from `values`, where they are contiguous, and frees the memory of `values` as it goes,
  /// so that the two never both take their full size. Throws std::bad_alloc, std::system_error if a file size
  /// limit (ulimit -f) forbids it, and WorkStopped as all long work.
  CopyOnWriteFloats(std::vector<float> values, const RowLayout& layout);
  CopyOnWriteFloats(const CopyOnWriteFloats& other);
  CopyOnWriteFloats(CopyOnWriteFloats&& other) noexcept { swap(other); }
  CopyOnWriteFloats& operator=(CopyOnWriteFloats other) noexcept {
    swap(other);
    return *this;
  }
  ~CopyOnWriteFloats();

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Returns a pointer to the first value. The 64 bytes after the last value are readable too.
  const float* data() const { return values_; }
  float operator[](std::size_t n) const { return values_[n]; }
  bool operator==(const CopyOnWriteFloats& other) const;

  /// Writes one value. Safe in the haptic tick, and fast if `prefault` was called.
  void set(std::size_t n, float value) noexcept {
    values_[n] = value;
    std::atomic_ref(written_[n / kPageFloats]).store(1, std::memory_order_relaxed);
  }
  /// Pre-faults the pages of [first, last], so that writing to them does not page-fault. One thread at a
  /// time, which need not be the writing thread. Not real-time safe.
  void prefault(std::size_t first, std::size_t last);

 private:
  class Original;
  static constexpr std::size_t kPageFloats = 1024;

  void map();
  void swap(CopyOnWriteFloats& other) noexcept;

  std::shared_ptr<const Original> original_;
  float* values_ = nullptr;
  std::size_t size_ = 0;
  // Per page: 1 if this copy has a private page, which may differ from the original.
  std::vector<std::uint8_t> written_;
};

}  // namespace osteomill
