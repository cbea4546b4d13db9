#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace osteomill {

/// Describes how rows of floats lie in one array: rows of `row_length` values begin `row_stride` apart,
/// slices of `slice_rows` rows `slice_stride` apart. The floats between them are 0 and unused.
struct RowLayout {
  std::size_t row_length = 0;
  std::size_t row_stride = 0;
  std::size_t slice_rows = 0;
  std::size_t slice_stride = 0;
  std::size_t slices = 0;

  /// Lays rows out apart: every row begins with a cache line, and rows that are neighbours, along j or along
  /// k, come to different sets of the caches: those of a scan 512 voxels wide would share so few that a
  /// burr's reach, a tenth of a cache's size, throws itself out again and again. Rows or slices of less than
  /// 64 lie one behind the other, because in thin scans the gaps would take most of the memory. Takes at most
  /// 1.6 times what the values take.
  static RowLayout with_padding(std::size_t row_length, std::size_t slice_rows, std::size_t slices);

  std::size_t size() const { return slice_stride * slices; }
};

/// An array of floats whose copies share its memory until they differ: a copy costs the pages (4 KiB) that
/// were written in it or in what it was copied from. Reading costs what reading any array does.
///
/// When a page is written for the first time the system makes a copy of it, which takes microseconds; for a
/// thread that cannot wait, another thread calls `prefault`. One thread writes; no thread copies meanwhile.
class CopyOnWriteFloats {
 public:
  CopyOnWriteFloats() = default;
  /// Takes the rows over from `values`, which holds them one behind the other, and gives their memory back
  /// meanwhile, so that both never stand whole. Throws std::bad_alloc; std::system_error if a limit on file
  /// sizes (ulimit -f) forbids it; and WorkStopped as all long work.
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
  /// Returns the first value. 64 bytes behind the last may be read too.
  const float* data() const { return values_; }
  float operator[](std::size_t n) const { return values_[n]; }
  bool operator==(const CopyOnWriteFloats& other) const;

  /// Writes one value. Safe in the haptic tick, and fast if `prefault` was called.
  void set(std::size_t n, float value) noexcept {
    values_[n] = value;
    std::atomic_ref(written_[n / kPageFloats]).store(1, std::memory_order_relaxed);
  }
  /// Makes the pages of [first, last] ready before they are written. One thread at a time, which may be
  /// another than the one that writes; waits for the system.
  void prefault(std::size_t first, std::size_t last);

 private:
  class Original;
  static constexpr std::size_t kPageFloats = 1024;

  void map();
  void swap(CopyOnWriteFloats& other) noexcept;

  std::shared_ptr<const Original> original_;
  float* values_ = nullptr;
  std::size_t size_ = 0;
  // For each page: whether it was made for this copy, and so may differ from the original.
  std::vector<std::uint8_t> written_;
};

}  // namespace osteomill
