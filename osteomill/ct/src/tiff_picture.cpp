#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <tiffio.h>

#include "osteomill/base/input_error.h"

#include "byte_source.h"
#include "picture_files.h"
#include "plausible_scan.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

struct Close {
  void operator()(TIFF* file) const { TIFFClose(file); }
};
using TiffFile = std::unique_ptr<TIFF, Close>;

// Stores the first error message in a string.
int keep_reason(TIFF*, void* reason, const char*, const char* format, std::va_list arguments) {
  auto& text = *static_cast<std::string*>(reason);
  if (!text.empty()) return 1;
  char line[200] = "";
  std::vsnprintf(line, sizeof(line), format, arguments);
  text = line;
  return 1;
}

int pass_over(TIFF*, void*, const char*, const char*, std::va_list) {
  return 1;
}

// Storage format of a page.
struct Layout {
  std::uint32_t columns = 0, rows = 0;
  std::uint16_t bits = 1, channels = 1, format = SAMPLEFORMAT_UINT, planes = PLANARCONFIG_CONTIG,
                photometric = 0;
};

template <typename Value>
void append(const std::uint8_t* bytes, std::size_t count, bool is_inverted, std::vector<float>& values) {
  for (std::size_t n = 0; n < count; ++n) {
    Value value{};
    std::memcpy(&value, bytes + n * sizeof(value), sizeof(value));
    if constexpr (std::numeric_limits<Value>::is_integer) {
      if (is_inverted) value = static_cast<Value>(std::numeric_limits<Value>::max() - value);
    }
    values.push_back(static_cast<float>(value));
  }
}

// Eight values per byte, the first in the highest bit; rows start at a byte.
void append_bits(const std::uint8_t* bytes, std::size_t count, bool is_inverted, std::vector<float>& values) {
  for (std::size_t n = 0; n < count; ++n)
    values.push_back(static_cast<float>((bytes[n / 8] >> (7 - n % 8) & 1) ^ static_cast<int>(is_inverted)));
}

using Append = void (*)(const std::uint8_t*, std::size_t, bool, std::vector<float>&);

Append append_of(const Layout& layout) {
  switch (layout.format * 100 + layout.bits) {
    case SAMPLEFORMAT_UINT * 100 + 1:
      return layout.channels == 1 ? append_bits : nullptr;
    case SAMPLEFORMAT_UINT * 100 + 8:
      return append<std::uint8_t>;
    case SAMPLEFORMAT_UINT * 100 + 16:
      return append<std::uint16_t>;
    case SAMPLEFORMAT_UINT * 100 + 32:
      return append<std::uint32_t>;
    case SAMPLEFORMAT_INT * 100 + 8:
      return append<std::int8_t>;
    case SAMPLEFORMAT_INT * 100 + 16:
      return append<std::int16_t>;
    case SAMPLEFORMAT_INT * 100 + 32:
      return append<std::int32_t>;
    case SAMPLEFORMAT_IEEEFP * 100 + 32:
      return append<float>;
    case SAMPLEFORMAT_IEEEFP * 100 + 64:
      return append<double>;
    default:
      return nullptr;
  }
}

class TiffReader {
 public:
  TiffReader(const fs::path& path, std::uint64_t max_bytes) : subject_(path.string()), max_bytes_(max_bytes) {
    open_regular_file(subject_, path);
    const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                   TIFFOpenOptionsFree);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_reason, &reason_);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), pass_over, nullptr);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(),
                                        static_cast<tmsize_t>(std::min(max_bytes, kMostBytes)));
    // Not memory-mapped: if the file were truncated meanwhile, the program would crash.
    file_.reset(TIFFOpenExt(path.c_str(), "rm", options.get()));
    if (!file_) refuse();
  }

  void read(const std::function<void(const Picture&)>& use) {
    do {
      std::uint32_t kind = 0;
      TIFFGetFieldDefaulted(file_.get(), TIFFTAG_SUBFILETYPE, &kind);
      // Ignores thumbnails and masks.
      if ((kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0) use(page());
    } while (TIFFReadDirectory(file_.get()) != 0);
    if (!reason_.empty()) refuse();
  }

 private:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40;

  [[noreturn]] void refuse() const {
    throw InputError(subject_,
                     fmt::format("cannot be read as TIFF{}{}", reason_.empty() ? "" : ": ", reason_));
  }

  Layout layout() const {
    Layout found;
    TIFF* const file = file_.get();
    TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &found.columns);
    TIFFGetField(file, TIFFTAG_IMAGELENGTH, &found.rows);
    TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &found.bits);
    TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &found.channels);
    TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLEFORMAT, &found.format);
    TIFFGetFieldDefaulted(file, TIFFTAG_PLANARCONFIG, &found.planes);
    TIFFGetField(file, TIFFTAG_PHOTOMETRIC, &found.photometric);
    if (found.format == SAMPLEFORMAT_VOID) found.format = SAMPLEFORMAT_UINT;
    return found;
  }

  Picture page() {
    const Layout layout = this->layout();
    const Append append = append_of(layout);
    const bool is_known = layout.photometric == PHOTOMETRIC_MINISBLACK ||
                          layout.photometric == PHOTOMETRIC_MINISWHITE ||
                          layout.photometric == PHOTOMETRIC_RGB;
    if (append == nullptr || !is_known || layout.columns == 0 || layout.rows == 0 || layout.channels > 4 ||
        (layout.planes != PLANARCONFIG_CONTIG && layout.channels > 1)) {
      throw InputError(subject_,
                       fmt::format("is TIFF of {} bits, {} channels, sample format {} and photometric "
                                   "interpretation {}, which is not supported",
                                   layout.bits, layout.channels, layout.format, layout.photometric));
    }
    Picture picture{layout.columns, layout.rows, layout.channels, layout.bits};
    const std::uint64_t values = std::uint64_t{layout.rows} * layout.columns * layout.channels;
    check_memory(subject_, values, max_bytes_);
    const std::size_t row_values = picture.columns * picture.channels,
                      row_bytes = (row_values * layout.bits + 7) / 8;
    const bool is_inverted = layout.photometric == PHOTOMETRIC_MINISWHITE;
    const auto append_row = [&](const std::uint8_t* row) {
      append(row, row_values, is_inverted, picture.values);
    };
    if (TIFFIsTiled(file_.get()) != 0)
      read_tiles(layout, row_bytes, append_row);
    else
      read_strips(layout, row_bytes, append_row);
    return picture;
  }

  template <typename AppendRow>
  void read_strips(const Layout& layout, std::size_t row_bytes, const AppendRow& append_row) {
    const tmsize_t size = TIFFStripSize(file_.get());
    if (size <= 0 || static_cast<std::uint64_t>(size) > max_bytes_) refuse();
    std::vector<std::uint8_t> strip(static_cast<std::size_t>(size));
    std::uint32_t row = 0;
    for (std::uint32_t n = 0; n < TIFFNumberOfStrips(file_.get()) && row < layout.rows; ++n) {
      const tmsize_t found = TIFFReadEncodedStrip(file_.get(), n, strip.data(), size);
      if (found < 0) refuse();
      for (std::size_t at = 0; at + row_bytes <= static_cast<std::size_t>(found) && row < layout.rows;
           ++row) {
        append_row(strip.data() + at);
        at += row_bytes;
      }
    }
    if (row < layout.rows) refuse();
  }

  // Reads a row of tiles at a time.
  template <typename AppendRow>
  void read_tiles(const Layout& layout, std::size_t row_bytes, const AppendRow& append_row) {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(file_.get(), TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(file_.get(), TIFFTAG_TILELENGTH, &height);
    const tmsize_t size = TIFFTileSize(file_.get());
    // Tile widths are multiples of 16, so tile rows are whole bytes.
    const std::uint64_t tile_row_bits = std::uint64_t{width} * layout.channels * layout.bits;
    const std::uint64_t tile_row_bytes = tile_row_bits / 8;
    if (width == 0 || tile_row_bits % 8 != 0 || height == 0 || size <= 0 ||
        static_cast<std::uint64_t>(size) < tile_row_bytes * height ||
        static_cast<std::uint64_t>(size) > max_bytes_ || row_bytes * std::uint64_t{height} > max_bytes_)
      refuse();
    std::vector<std::uint8_t> tile(static_cast<std::size_t>(size));
    std::vector<std::uint8_t> band(row_bytes * std::min(height, layout.rows));
    for (std::uint32_t top = 0; top < layout.rows; top += height) {
      const std::uint32_t rows = std::min(height, layout.rows - top);
      for (std::uint32_t left = 0; left < layout.columns; left += width) {
        if (TIFFReadEncodedTile(file_.get(), TIFFComputeTile(file_.get(), left, top, 0, 0), tile.data(),
                                size) < 0)
          refuse();
        const std::size_t first = std::size_t{left} * layout.channels * layout.bits / 8;
        for (std::uint32_t row = 0; row < rows; ++row)
          std::memcpy(band.data() + row * row_bytes + first, tile.data() + row * tile_row_bytes,
                      std::min<std::size_t>(tile_row_bytes, row_bytes - first));
      }
      for (std::uint32_t row = 0; row < rows; ++row) append_row(band.data() + row * row_bytes);
    }
  }

  std::string subject_;
  std::uint64_t max_bytes_;
  std::string reason_;
  TiffFile file_;
};

}  // namespace

void read_tiff(const fs::path& path, std::uint64_t max_bytes,
               const std::function<void(const Picture&)>& use) {
  TiffReader(path, max_bytes).read(use);
}

}  // namespace osteomill
