#include <cstring>

#include <png.h>
#include <tiffio.h>

#include "osteomill/volume/label_scan.h"

#include "tests/support/folder_test.h"

namespace osteomill {
namespace {

using testing_support::contains;

constexpr std::uint32_t kColumns = 5, kRows = 4, kSlices = 12;

// Value at a position of a stack, unique for each position.
int value_at(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  return static_cast<int>(i + kColumns * (j + kRows * k));
}

class PictureStack : public testing_support::FolderTest {
 protected:
  // Writes a picture with libpng; `pixel(i, j)` returns the channels of a pixel.
  template <typename Value>
  void write_png(const std::string& name, int colour_type,
                 const std::function<std::vector<Value>(std::uint32_t, std::uint32_t)>& pixel,
                 std::uint32_t columns = kColumns) const {
    std::FILE* const file = std::fopen((folder_ / name).c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, columns, kRows, 8 * sizeof(Value), colour_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    // Gamma is for display and must not change values.
    png_set_gAMA(png, info, 0.45455);
    png_write_info(png, info);
    if (sizeof(Value) == 2) png_set_swap(png);
    for (std::uint32_t j = 0; j < kRows; ++j) {
      std::vector<Value> row;
      for (std::uint32_t i = 0; i < columns; ++i)
        for (const Value value : pixel(i, j)) row.push_back(value);
      png_write_row(png, reinterpret_cast<png_const_bytep>(row.data()));
    }
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
  }
  void write_grey_pngs() const {
    for (std::uint32_t k = 0; k < kSlices; ++k)
      write_png<std::uint16_t>(
          "slice" + std::to_string(k) + ".png", PNG_COLOR_TYPE_GRAY, [&](auto i, auto j) {
            return std::vector<std::uint16_t>{static_cast<std::uint16_t>(270 * value_at(i, j, k))};
          });
  }
  // Writes one page per slice, floats in strips or tiles.
  std::filesystem::path write_pages(const std::string& name, bool tiled, std::uint16_t photometric) const {
    TIFF* const file = TIFFOpen((folder_ / name).c_str(), "w");
    for (std::uint32_t k = 0; k < kSlices; ++k) {
      TIFFSetField(file, TIFFTAG_IMAGEWIDTH, kColumns);
      TIFFSetField(file, TIFFTAG_IMAGELENGTH, kRows);
      TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 16);
      TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
      TIFFSetField(file, TIFFTAG_PHOTOMETRIC, photometric);
      TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
      const auto value = [&](std::uint32_t i, std::uint32_t j) {
        const int stored = 270 * value_at(i, j, k);
        return static_cast<std::uint16_t>(photometric == PHOTOMETRIC_MINISWHITE ? 65535 - stored : stored);
      };
      if (tiled) {
        TIFFSetField(file, TIFFTAG_TILEWIDTH, 16);
        TIFFSetField(file, TIFFTAG_TILELENGTH, 16);
        std::vector<std::uint16_t> tile(16 * 16);
        for (std::uint32_t j = 0; j < kRows; ++j)
          for (std::uint32_t i = 0; i < kColumns; ++i) tile[16 * j + i] = value(i, j);
        TIFFWriteEncodedTile(file, 0, tile.data(), 2 * 16 * 16);
      } else {
        TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, 3);
        for (std::uint32_t j = 0; j < kRows; ++j) {
          std::vector<std::uint16_t> row;
          for (std::uint32_t i = 0; i < kColumns; ++i) row.push_back(value(i, j));
          TIFFWriteScanline(file, row.data(), j);
        }
      }
      TIFFWriteDirectory(file);
    }
    TIFFClose(file);
    return folder_ / name;
  }

  static Scan read(const std::filesystem::path& path) {
    return read_scan(path, {.spacing_mm = Vec3(0.1, 0.2, 0.3)});
  }
  static void expect_values(const Scan& scan) {
    const GridGeometry& geometry = scan.grid.geometry();
    ASSERT_EQ(geometry.dims, (std::array<int, 3>{kColumns, kRows, kSlices}));
    EXPECT_EQ(geometry.spacing_mm, Vec3(0.1, 0.2, 0.3));
    for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
      EXPECT_EQ(scan.grid[v], static_cast<float>(270 * value_at(static_cast<std::uint32_t>(v.i),
                                                                static_cast<std::uint32_t>(v.j),
                                                                static_cast<std::uint32_t>(v.k))));
    });
    EXPECT_FALSE(scan.is_labels);
  }
  static std::string refusal_of(const std::filesystem::path& path) {
    try {
      read(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(PictureStack, OrdersPngSlicesByNumber) {
  write_grey_pngs();
  const Scan scan = read(folder_);
  expect_values(scan);
  EXPECT_EQ(scan.format, "PNG");
  EXPECT_TRUE(contains(refusal(folder_), "no voxel spacing; give it with --spacing"));
  write_png<std::uint16_t>(
      "slice12.png", PNG_COLOR_TYPE_GRAY, [](auto, auto) { return std::vector<std::uint16_t>{1}; }, 6);
  EXPECT_TRUE(contains(refusal_of(folder_), "slice12.png: is a picture of 6 x 4 pixels"));
}

TEST_F(PictureStack, DetectsMissingAndForeignSlicesByName) {
  write_grey_pngs();
  const auto path = [&](const std::string& name) { return folder_ / name; };
  std::filesystem::rename(path("slice7.png"), path("slice27.png"));
  EXPECT_TRUE(contains(refusal_of(folder_),
                       "a slice is missing: slice8.png follows slice6.png, and numbers grow "
                       "by 1 otherwise"));
  std::filesystem::rename(path("slice27.png"), path("mask7.png"));
  EXPECT_TRUE(contains(refusal_of(folder_), "in more than numbers: mask7.png and slice0.png"));
  std::filesystem::rename(path("mask7.png"), path("slice7.png"));
  for (std::uint32_t k = 0; k < kSlices; ++k)
    std::filesystem::rename(path("slice" + std::to_string(k) + ".png"),
                            path("z2_" + std::to_string(95 + 5 * k) + "_.png"));
  expect_values(read(folder_));
  // Numbers that are times of day, or positions in other units.
  std::filesystem::rename(path("z2_110_.png"), path("z2_112_.png"));
  EXPECT_TRUE(contains(read(folder_).warnings.at(0), "grow unevenly (z2_112_.png follows z2_105_.png)"));
}

TEST_F(PictureStack, ReadsOneBitPagesAsZeroAndOne) {
  for (const int photometric : {PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_MINISWHITE}) {
    TIFF* const file = TIFFOpen((folder_ / "a.tif").c_str(), "w");
    for (int page = 0; page < 2; ++page) {
      TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 11);
      TIFFSetField(file, TIFFTAG_IMAGELENGTH, 2);
      TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 1);
      TIFFSetField(file, TIFFTAG_PHOTOMETRIC, photometric);
      TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_CCITTFAX4);
      for (std::uint32_t row = 0; row < 2; ++row) {
        std::array<std::uint8_t, 2> bits{static_cast<std::uint8_t>(row == 0 ? 0x81 : 0), 0x20};
        TIFFWriteScanline(file, bits.data(), row);
      }
      TIFFWriteDirectory(file);
    }
    TIFFClose(file);
    const Scan scan = read(folder_ / "a.tif");
    for (int i = 0; i < 11; ++i) {
      const bool set = i == 0 || i == 7 || i == 10;
      const VoxelIndex v{i, 0, 1};
      EXPECT_EQ(scan.grid[v], set == (photometric == PHOTOMETRIC_MINISBLACK) ? 1 : 0) << i;
    }
  }
}

TEST_F(PictureStack, ReadsTiffPagesAsSlices) {
  for (const bool tiled : {false, true}) {
    for (const int photometric : {PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_MINISWHITE}) {
      const Scan scan = read(write_pages("a.tif", tiled, static_cast<std::uint16_t>(photometric)));
      expect_values(scan);
      EXPECT_EQ(scan.format, "TIFF");
    }
  }
  const auto path = write_pages("b.tif", false, PHOTOMETRIC_MINISBLACK);
  const auto size = std::filesystem::file_size(path);
  for (auto length = size - 1; length > size / 8; length -= size / 8) {
    std::filesystem::resize_file(path, length);
    EXPECT_TRUE(contains(refusal_of(path), "b.tif: cannot be read as TIFF")) << length;
  }
}

TEST_F(PictureStack, ReadsColoursAsLabelsUnlessAllAreGrey) {
  const std::array<std::array<std::uint8_t, 4>, 3> colours{
      {{9, 9, 9, 0}, {200, 10, 10, 255}, {10, 10, 200, 255}}};
  for (int k = 0; k < 3; ++k) {
    write_png<std::uint8_t>("c" + std::to_string(k) + ".png", PNG_COLOR_TYPE_RGB_ALPHA, [&](auto i, auto) {
      const auto& colour = colours[(i + static_cast<unsigned>(k)) % 3];
      return std::vector<std::uint8_t>(colour.begin(), colour.end());
    });
  }
  const Scan labels = read(folder_);
  EXPECT_TRUE(labels.is_labels);
  for (const auto& [v, label] :
       {std::pair<VoxelIndex, float>{{0, 0, 0}, 0}, {{1, 0, 0}, 1}, {{2, 3, 0}, 2}, {{0, 0, 2}, 2}})
    EXPECT_EQ(labels.grid[v], label);
  for (int k = 0; k < 3; ++k) {
    write_png<std::uint8_t>("c" + std::to_string(k) + ".png", PNG_COLOR_TYPE_RGB, [&](auto i, auto) {
      return std::vector<std::uint8_t>(3, static_cast<std::uint8_t>(40 * i));
    });
  }
  const Scan grey = read(folder_);
  EXPECT_FALSE(grey.is_labels);
  const VoxelIndex third{2, 0, 0};
  EXPECT_EQ(grey.grid[third], 80);
}

TEST_F(PictureStack, RefusesAnInvalidStackWithAReason) {
  write_grey_pngs();
  EXPECT_TRUE(contains(refusal_of(folder_ / "slice3.png"), "is a single picture; choose the folder"));
  std::filesystem::resize_file(folder_ / "slice3.png", 60);
  EXPECT_TRUE(contains(refusal_of(folder_), "slice3.png: cannot be read as PNG: "));
  write("slice3.png", "hello");
  EXPECT_TRUE(contains(refusal_of(folder_), "slice3.png: cannot be read as PNG: "));
  std::filesystem::create_directory(folder_ / "more");
  write("more/x.png", "hello");
  EXPECT_TRUE(contains(refusal_of(folder_), "in several folders"));
  const std::string nrrd =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nspacings: 1 1 1\nencoding: raw\n\n1";
  EXPECT_TRUE(contains(refusal_of(write("a.nrrd", nrrd)), "is NRRD, which has its own voxel spacing"));
}

}  // namespace
}  // namespace osteomill
