#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <string>

#include <fmt/format.h>
#include <png.h>

#include "osteomill/base/input_error.h"

#include "byte_source.h"
#include "picture_files.h"
#include "plausible_scan.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// State of libpng. It reports errors by longjmp, so functions that call it must not have local objects with
// destructors.
struct PngFile {
  PngFile() = default;
  ~PngFile() {
    if (png != nullptr) png_destroy_read_struct(&png, &info, nullptr);
    if (file != nullptr) std::fclose(file);
  }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  std::FILE* file = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;
  // Error message of libpng.
  char fault[128] = "";
};

[[noreturn]] void stop(png_structp png, png_const_charp reason) {
  auto& in = *static_cast<PngFile*>(png_get_error_ptr(png));
  std::strncpy(in.fault, reason, sizeof(in.fault) - 1);
  png_longjmp(png, 1);
}

void pass_over(png_structp, png_const_charp) {}

// Sets up reading: values as stored, in one byte or in two of native order; palette values as colours.
bool read_head(PngFile& in) {
  if (setjmp(png_jmpbuf(in.png)) != 0) return false;
  png_init_io(in.png, in.file);
  png_read_info(in.png, in.info);
  if (png_get_color_type(in.png, in.info) == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(in.png);
  png_set_packing(in.png);
  if (png_get_bit_depth(in.png, in.info) == 16) png_set_swap(in.png);
  png_set_interlace_handling(in.png);
  png_read_update_info(in.png, in.info);
  return true;
}

bool read_rows(PngFile& in, png_bytepp rows) {
  if (setjmp(png_jmpbuf(in.png)) != 0) return false;
  png_read_image(in.png, rows);
  png_read_end(in.png, nullptr);
  return true;
}

}  // namespace

void read_png(const fs::path& path, std::uint64_t max_bytes, const std::function<void(const Picture&)>& use) {
  const std::string subject = path.string();
  open_regular_file(subject, path);
  PngFile in;
  in.file = std::fopen(path.c_str(), "rb");
  in.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &in, stop, pass_over);
  in.info = in.png == nullptr ? nullptr : png_create_info_struct(in.png);
  if (in.file == nullptr || in.info == nullptr) throw InputError(subject, "cannot be read");
  const auto refuse = [&] { throw InputError(subject, fmt::format("cannot be read as PNG: {}", in.fault)); };
  if (!read_head(in)) refuse();
  Picture picture{.columns = png_get_image_width(in.png, in.info),
                  .rows = png_get_image_height(in.png, in.info),
                  .channels = png_get_channels(in.png, in.info),
                  .bits = png_get_bit_depth(in.png, in.info) == 16 ? 16 : 8};
  const std::size_t row_bytes = png_get_rowbytes(in.png, in.info);
  check_memory(subject, picture.rows * (picture.columns * picture.channels + row_bytes), max_bytes);
  std::vector<png_byte> bytes(picture.rows * row_bytes);
  std::vector<png_bytep> rows;
  for (std::size_t row = 0; row < picture.rows; ++row) rows.push_back(bytes.data() + row * row_bytes);
  if (!read_rows(in, rows.data())) refuse();
  picture.values.reserve(picture.rows * picture.columns * picture.channels);
  for (const png_bytep row : rows) {
    for (std::size_t n = 0; n < picture.columns * picture.channels; ++n) {
      std::uint16_t value = row[n];
      if (picture.bits == 16) std::memcpy(&value, row + 2 * n, sizeof(value));
      picture.values.push_back(value);
    }
  }
  use(picture);
}

}  // namespace osteomill
