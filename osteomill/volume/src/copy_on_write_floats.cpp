#include "osteomill/volume/copy_on_write_floats.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>
#include <utility>

#include <sys/mman.h>
#include <unistd.h>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kPaddingBytes = 64;

std::size_t mapped_bytes(std::size_t floats) {
  return (floats * sizeof(float) + kPaddingBytes + kPageBytes - 1) / kPageBytes * kPageBytes;
}

[[noreturn]] void throw_system_error() {
  if (errno != EFBIG) throw std::bad_alloc();
  throw std::system_error(errno, std::generic_category(),
                          "the densities exceed the file size limit; raise it (ulimit -f)");
}

void write_all(int file, const char* bytes, std::size_t count, std::size_t at) {
  while (count > 0) {
    const ssize_t written = pwrite(file, bytes, count, static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw_system_error();
    bytes += written;
    at += static_cast<std::size_t>(written);
    count -= static_cast<std::size_t>(written);
  }
}

// Frees the pages wholly inside [from, to).
void release_pages(float* from, float* to) {
  const auto up = (reinterpret_cast<std::uintptr_t>(from) + kPageBytes - 1) / kPageBytes * kPageBytes;
  const auto down = reinterpret_cast<std::uintptr_t>(to) / kPageBytes * kPageBytes;
  if (up < down) madvise(reinterpret_cast<void*>(up), down - up, MADV_DONTNEED);
}

}  // namespace

// Anonymous in-memory file (memfd), constant once filled.
class CopyOnWriteFloats::Original {
 public:
  Original(std::vector<float> values, const RowLayout& layout)
      : file_(memfd_create("osteomill", MFD_CLOEXEC)) {
    if (file_ < 0) throw std::bad_alloc();
    try {
      fill(values, layout);
    } catch (...) {
      close(file_);
      throw;
    }
  }
  ~Original() { close(file_); }
  Original(const Original&) = delete;
  Original& operator=(const Original&) = delete;

  int file() const { return file_; }

 private:
  void fill(std::vector<float>& values, const RowLayout& layout) const {
    if (ftruncate(file_, static_cast<off_t>(mapped_bytes(layout.size()))) != 0) throw_system_error();
    constexpr std::size_t kAtOnce = 1 << 22;
    const std::size_t rows = layout.slice_rows * layout.slices;
    std::vector<float> piece;
    std::size_t written = 0;
    float *begin = values.data(), *from = begin;
    for (std::size_t row = 0; row < rows; ++row, from += layout.row_length) {
      const std::size_t at =
          row / layout.slice_rows * layout.slice_stride + row % layout.slice_rows * layout.row_stride;
      piece.resize(at - written);
      piece.insert(piece.end(), from, from + layout.row_length);
      if (piece.size() < kAtOnce && row + 1 < rows) continue;
      write_all(file_, reinterpret_cast<const char*>(piece.data()), piece.size() * sizeof(float),
                written * sizeof(float));
      release_pages(begin, from + layout.row_length);
      begin = from + layout.row_length;
      written += piece.size();
      piece.clear();
      WorkProgress::done(row + 1, rows);
    }
  }

  int file_;
};

RowLayout RowLayout::with_padding(std::size_t row_length, std::size_t slice_rows, std::size_t slices) {
  constexpr std::size_t kLineFloats = 16;
  // Sets of a 32 KiB L1 cache. Rows of an odd number of lines cycle through all of them.
  constexpr std::size_t kSets = 64;
  // Number of rows of a slice whose sets precede those of the next slice's first row.
  constexpr std::size_t kRowsTogether = 12;
  constexpr std::size_t kThin = 64;
  if (row_length < kThin || slice_rows < kThin)
    return {row_length, row_length, slice_rows, row_length * slice_rows, slices};
  const std::size_t row_lines = (row_length + kLineFloats - 1) / kLineFloats | 1;
  const std::size_t least = slice_rows * row_lines, wanted = kRowsTogether * row_lines;
  const std::size_t slice_lines = least + (wanted - least) % kSets;
  return {row_length, row_lines * kLineFloats, slice_rows, slice_lines * kLineFloats, slices};
}

CopyOnWriteFloats::CopyOnWriteFloats(std::vector<float> values, const RowLayout& layout)
    : size_(layout.size()) {
  if (values.empty()) return;
  original_ = std::make_shared<const Original>(std::move(values), layout);
  written_.assign(mapped_bytes(size_) / kPageBytes, 0);
  map();
}

CopyOnWriteFloats::CopyOnWriteFloats(const CopyOnWriteFloats& other)
    : original_(other.original_), size_(other.size_), written_(other.written_.size()) {
  if (empty()) return;
  map();
  // Another thread may be pre-faulting pages, which does not change their contents.
  for (std::size_t page = 0; page < written_.size(); ++page) {
    auto& made = const_cast<std::uint8_t&>(other.written_[page]);
    written_[page] = std::atomic_ref(made).load(std::memory_order_relaxed);
  }
  // Drops the source's private pages, so that both copies map the same physical pages.
  if (std::ranges::count(written_, 0) == std::ssize(written_)) {
    madvise(other.values_, mapped_bytes(size_), MADV_DONTNEED);
  }
  for (std::size_t page = 0; page < written_.size(); ++page) {
    if (written_[page] == 0) continue;
    std::memcpy(values_ + page * kPageFloats, other.values_ + page * kPageFloats, kPageBytes);
  }
}

CopyOnWriteFloats::~CopyOnWriteFloats() {
  if (values_ != nullptr) munmap(values_, mapped_bytes(size_));
}

void CopyOnWriteFloats::map() {
  void* mapped = mmap(nullptr, mapped_bytes(size_), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_NORESERVE,
                      original_->file(), 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  values_ = static_cast<float*>(mapped);
}

void CopyOnWriteFloats::swap(CopyOnWriteFloats& other) noexcept {
  std::swap(original_, other.original_);
  std::swap(values_, other.values_);
  std::swap(size_, other.size_);
  std::swap(written_, other.written_);
}

bool CopyOnWriteFloats::operator==(const CopyOnWriteFloats& other) const {
  return std::equal(values_, values_ + size_, other.values_, other.values_ + other.size_);
}

void CopyOnWriteFloats::prefault(std::size_t first, std::size_t last) {
  const std::size_t end = last / kPageFloats + 1;
  const auto made = [&](std::size_t page) {
    return std::atomic_ref(written_[page]).load(std::memory_order_relaxed) != 0;
  };
  for (std::size_t page = first / kPageFloats; page < end;) {
    if (made(page)) {
      ++page;
      continue;
    }
    const std::size_t begin = page;
    while (page < end && !made(page)) std::atomic_ref(written_[page++]).store(1, std::memory_order_relaxed);
#ifdef MADV_POPULATE_WRITE
    // If the kernel does not support this, pages are copied on their first write.
    madvise(values_ + begin * kPageFloats, (page - begin) * kPageBytes, MADV_POPULATE_WRITE);
#endif
  }
}

}  // namespace osteomill
