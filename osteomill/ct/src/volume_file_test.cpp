#include <algorithm>
#include <cstring>
#include <limits>

#include <sys/stat.h>
#include <zlib.h>

#include "tests/support/folder_test.h"

namespace osteomill {
namespace {

using testing_support::contains;

class VolumeFile : public testing_support::FolderTest {
 protected:
  std::filesystem::path write_gzip(const std::string& name, const std::string& bytes) const {
    gzFile packed = gzopen((folder_ / name).c_str(), "wb");
    gzwrite(packed, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(packed);
    return folder_ / name;
  }
};

constexpr std::array<int, 3> kDims{4, 3, 2};

// Voxel (i, j, k) has the value i + 10 j + 100 k - 50.
template <typename Stored>
std::string voxels() {
  std::string bytes;
  for (int k = 0; k < kDims[2]; ++k) {
    for (int j = 0; j < kDims[1]; ++j) {
      for (int i = 0; i < kDims[0]; ++i) {
        const auto value = static_cast<Stored>(i + 10 * j + 100 * k - 50);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
      }
    }
  }
  return bytes;
}

void expect_voxels(const DensityGrid& grid) {
  ASSERT_EQ(grid.geometry().dims, kDims);
  for (int k = 0; k < kDims[2]; ++k) {
    for (int j = 0; j < kDims[1]; ++j) {
      for (int i = 0; i < kDims[0]; ++i) {
        const VoxelIndex v{i, j, k};
        EXPECT_EQ(grid[v], static_cast<float>(i + 10 * j + 100 * k - 50));
      }
    }
  }
}

std::string nrrd(const std::string& fields, const std::string& data) {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nendian: little\n" + fields + "\n" + data;
}

const std::string kPlaced =
    "space: LPS\nspace directions: (0,0.5,0) (0,0,0.25) (2,0,0)\nspace origin: (1,-2,3)\n";

std::string mha(const std::string& fields, const std::string& data) {
  return "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\n" + fields +
         "ElementType = MET_SHORT\nElementDataFile = LOCAL\n" + data;
}

std::string zipped(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           static_cast<uLong>(bytes.size()));
  packed.resize(size);
  return packed;
}

std::string swapped(std::string bytes, std::size_t size) {
  for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
  }
  return bytes;
}

// Returns a NIfTI-1 header with the byte order swapped for the numbers that `Nifti` sets.
std::string swapped_header(std::string header) {
  const auto swap = [&](std::size_t at, std::size_t end, std::size_t size) {
    header.replace(at, end - at, swapped(header.substr(at, end - at), size));
  };
  swap(0, 4, 4);
  swap(40, 56, 2);
  swap(70, 74, 2);
  swap(76, 120, 4);
  swap(252, 256, 2);
  swap(256, 328, 4);
  return header;
}

// NIfTI-1 header with the layout of nifti1.h.
class Nifti {
 public:
  Nifti() : bytes_(352, '\0') {
    set<std::int32_t>(0, 348);
    for (const auto& [offset, value] : {std::pair{40, 3}, {42, 4}, {44, 3}, {46, 2}, {70, 4}, {72, 16}}) {
      set<std::int16_t>(offset, static_cast<std::int16_t>(value));
    }
    for (const auto& [offset, value] :
         {std::pair{76, 1.0F}, {80, 0.5F}, {84, 0.25F}, {88, 2.0F}, {108, 352.0F}}) {
      set<float>(offset, value);
    }
    bytes_[123] = 2;
    std::memcpy(bytes_.data() + 344, "n+1", 3);
    set<std::int16_t>(254, 1);
    const std::array<float, 12> rows{0, 0, 2, 1, 0.5F, 0, 0, -2, 0, 0.25F, 0, 3};
    for (int n = 0; n < 12; ++n) set<float>(280 + 4 * n, rows[static_cast<std::size_t>(n)]);
  }
  template <typename Number>
  Nifti& set(int offset, Number value) {
    std::memcpy(bytes_.data() + offset, &value, sizeof(value));
    return *this;
  }
  std::string with(const std::string& data) const { return bytes_ + data; }

 private:
  std::string bytes_;
};

TEST_F(VolumeFile, NrrdIsPlacedByItsSpaceDirections) {
  const Scan scan = read_scan(write("a.nrrd", nrrd("encoding: raw\n" + kPlaced, voxels<std::int16_t>())));
  expect_voxels(scan.grid);
  EXPECT_EQ(scan.format, "NRRD");
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(1 + 6, -2 + 0.5, 3 + 0.5)));
}

TEST_F(VolumeFile, ConvertsRasToLps) {
  std::string fields = "encoding: raw\n" + kPlaced;
  fields.replace(fields.find("LPS"), 3, "RAS");
  const Scan scan = read_scan(write("a.nrrd", nrrd(fields, voxels<std::int16_t>())));
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(-7, 1.5, 3.5)));
}

TEST_F(VolumeFile, DetachedAndCompressedNrrdYieldTheSameVoxels) {
  write("a.raw", "skip" + voxels<std::int16_t>());
  expect_voxels(
      read_scan(write("a.nhdr", nrrd("encoding: raw\nbyte skip: 4\ndata file: a.raw\n" + kPlaced, ""))).grid);
  expect_voxels(
      read_scan(write("b.nhdr", nrrd("encoding: raw\nbyte skip: -1\ndata file: a.raw\n" + kPlaced, "")))
          .grid);
  write_gzip("a.gz", voxels<std::int16_t>());
  expect_voxels(read_scan(write("c.nhdr", nrrd("encoding: gzip\ndata file: a.gz\n" + kPlaced, ""))).grid);
}

TEST_F(VolumeFile, ConvertsLasToLps) {
  std::string fields = "encoding: raw\n" + kPlaced;
  fields.replace(fields.find("LPS"), 3, "LAS");
  const Scan scan = read_scan(write("a.nrrd", nrrd(fields, voxels<std::int16_t>())));
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(7, 1.5, 3.5)));
}

TEST_F(VolumeFile, EveryTypeAndByteOrderYieldsTheSameVoxels) {
  for (const auto& [type, bytes, met, code] : {std::tuple{"short", voxels<std::int16_t>(), "MET_SHORT", 4},
                                               {"int", voxels<std::int32_t>(), "MET_INT", 8},
                                               {"int64", voxels<std::int64_t>(), "MET_LONG_LONG", 1024},
                                               {"float", voxels<float>(), "MET_FLOAT", 16},
                                               {"double", voxels<double>(), "MET_DOUBLE", 64}}) {
    const std::size_t size = bytes.size() / 24;
    for (const bool big : {false, true}) {
      SCOPED_TRACE(std::string(type) + (big ? " big endian" : " little endian"));
      const std::string data = big ? swapped(bytes, size) : bytes;
      std::string header = nrrd("encoding: raw\n" + kPlaced, data);
      header.replace(header.find("short"), 5, type);
      if (big) header.replace(header.find("little"), 6, "big");
      expect_voxels(read_scan(write("a.nrrd", header)).grid);

      header = mha(big ? "BinaryDataByteOrderMSB = True\n" : "", data);
      header.replace(header.find("MET_SHORT"), 9, met);
      expect_voxels(read_scan(write("a.mha", header)).grid);

      header = Nifti().set<std::int16_t>(70, static_cast<std::int16_t>(code)).with("");
      expect_voxels(read_scan(write("a.nii", (big ? swapped_header(header) : header) + data)).grid);
    }
  }
}

TEST_F(VolumeFile, ReadsTextVoxelsAndRefusesInvalidNumbers) {
  const std::string fields = "encoding: ascii\n" + kPlaced;
  std::string text;
  for (int k = 0; k < kDims[2]; ++k) {
    for (int j = 0; j < kDims[1]; ++j) {
      for (int i = 0; i < kDims[0]; ++i)
        text += std::to_string(i + 10 * j + 100 * k - 50) + (i == 3 ? "\n" : " ");
    }
  }
  expect_voxels(read_scan(write("a.nrrd", nrrd(fields, text))).grid);
  const std::string shorter = text.substr(0, text.rfind(' '));
  EXPECT_TRUE(contains(refusal(write("b.nrrd", nrrd(fields, shorter))), "24 voxels but has 23 numbers"));
  for (const char* odd : {"1x", "1.5", "40000", "nan", "(1)"}) {
    const std::string other = shorter + " " + odd + "\n";
    EXPECT_TRUE(contains(refusal(write("c.nrrd", nrrd(fields, other))), "c.nrrd: holds ")) << odd;
  }
  const std::string long_line = std::string(100'000, 'x');
  EXPECT_LT(refusal(write("d.nrrd", nrrd(fields, text.substr(0, 60) + long_line))).size(), 200U);
}

TEST_F(VolumeFile, SkipsBytesBeforeCompressedVoxels) {
  const std::string bytes = "skip" + voxels<std::int16_t>();
  write_gzip("a.gz", bytes);
  for (const char* skip : {"4", "-1"}) {
    const std::string fields =
        std::string("encoding: gzip\nbyte skip: ") + skip + "\ndata file: a.gz\n" + kPlaced;
    expect_voxels(read_scan(write("a.nhdr", nrrd(fields, ""))).grid);
  }
}

TEST_F(VolumeFile, RefusesUnknownFieldsSpacesAndKinds) {
  const std::string data = voxels<std::int16_t>();
  EXPECT_TRUE(contains(refusal(write("a.nrrd", nrrd("encoding: raw\nspace drections: 1\n", data))),
                       "unknown field \"spacedrections\""));
  EXPECT_TRUE(contains(refusal(write("b.nrrd", nrrd("encoding: raw\nspace: left-posterior\n", data))),
                       "in an unknown space"));
  EXPECT_TRUE(contains(refusal(write("c.nrrd", nrrd("encoding: raw\nkinds: vector domain domain\n", data))),
                       "axis of kind"));
  const std::string long_key(70'000, 'x');
  EXPECT_LT(refusal(write("d.nrrd", nrrd("encoding: raw\n" + long_key + ": 1\n", data))).size(), 200U);
}

// Reading a pipe would block.
TEST_F(VolumeFile, RefusesAPipeAsDataFile) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(contains(refusal(write("a.nhdr", nrrd("encoding: raw\nline skip: 1\ndata file: pipe\n", ""))),
                       "pipe is not a regular file"));
}

TEST_F(VolumeFile, ConvertsUnitsOfLengthToMillimetres) {
  const std::string fields = "encoding: raw\nspacings: 20 20 40\nunits: \"um\" \"um\" \"um\"\n";
  const Scan scan = read_scan(write("a.nrrd", nrrd(fields, voxels<std::int16_t>())));
  EXPECT_TRUE(scan.grid.geometry().spacing_mm.isApprox(Vec3(0.02, 0.02, 0.04)));
}

TEST_F(VolumeFile, AppliesTheUnitOfEachAxis) {
  const auto spacing_of = [&](const std::string& fields) {
    return Vec3(read_scan(write("a.nrrd", nrrd("encoding: raw\n" + fields, voxels<std::int16_t>())))
                    .grid.geometry()
                    .spacing_mm);
  };
  EXPECT_TRUE(spacing_of("spacings: 1 2 50\nunits: \"mm\" \"cm\" \"um\"\n").isApprox(Vec3(1, 20, 0.05)));
  EXPECT_TRUE(spacing_of("spacings: 1 2 50\nunits: mm mm um\n").isApprox(Vec3(1, 2, 0.05)));
  EXPECT_TRUE(spacing_of("spacings: 20 20 50\nunits: \"um\"\n").isApprox(Vec3(0.02, 0.02, 0.05)));
  // Space units apply to the directions of the space, whatever axes run along them.
  const std::string placed =
      "space: LPS\nspace directions: (0,0,40) (0,2,0) (3,0,0)\nspace origin: (1,2,500)\n"
      "space units: \"mm\" \"mm\" \"um\"\n";
  EXPECT_TRUE(spacing_of(placed).isApprox(Vec3(0.04, 2, 3)));
  EXPECT_TRUE(read_scan(folder_ / "a.nrrd").grid.geometry().origin_mm.isApprox(Vec3(1, 2, 0.5)));
  EXPECT_TRUE(contains(refusal(write("b.nrrd", nrrd("encoding: raw\nspacings: 1 1 1\nunits: \"mm\" \"mm\"\n",
                                                    voxels<std::int16_t>()))),
                       "2 units for its 3 axes"));
}

// Voxels in three files of 8 and in two of 12.
TEST_F(VolumeFile, JoinsVoxelsOfSeveralFilesInOrder) {
  const std::string bytes = voxels<std::int16_t>();
  for (std::size_t n = 0; n < 3; ++n)
    write("s0" + std::to_string(8 + n) + ".raw", "x\n1234" + bytes.substr(16 * n, 16));
  for (std::size_t n = 0; n < 2; ++n) write_gzip("z" + std::to_string(n) + ".gz", bytes.substr(24 * n, 24));
  const std::string skip = "encoding: raw\nline skip: 1\nbyte skip: 4\n" + kPlaced + "data file: ";
  for (const char* files : {"LIST\ns08.raw\n\n s09.raw\r\ns010.raw\n", "LIST 3\ns08.raw\ns09.raw\ns010.raw",
                            "s0%d.raw 8 10 1\n"}) {
    std::string header = nrrd(skip + files, "");
    expect_voxels(read_scan(write("a.nhdr", header)).grid);
  }
  const std::string packed = "encoding: gzip\n" + kPlaced + "data file: ";
  expect_voxels(read_scan(write("b.nhdr", nrrd(packed + "z%01d.gz 0 1 1 2\n", ""))).grid);
  for (const char* files : {"LIST\nz0.gz\nz1.gz\n", "z%d.gz 0 1 1\n"}) {
    std::string header = mha("CompressedData = True\n", "");
    header.replace(header.find("LOCAL\n"), std::string::npos, files);
    expect_voxels(read_scan(write("c.mhd", header)).grid);
  }
  const auto refused = [&](const std::string& files) {
    return refusal(write("d.nhdr", nrrd(packed + files, "")));
  };
  EXPECT_TRUE(contains(refused("LIST\n"), "empty list"));
  EXPECT_TRUE(contains(refused("LIST\nz0.gz\nz2.gz\n"), "z2.gz does not exist"));
  EXPECT_TRUE(contains(refused("LIST\nz0.gz\nz1.gz\nz0.gz\nz1.gz\nz1.gz\n"), "24 voxels in 5 files"));
  EXPECT_TRUE(contains(refused("z%d.gz 0 1 0\n"), "invalid range"));
  EXPECT_TRUE(contains(refused("z%d.gz 0 99999999 1\n"), "invalid range"));
  EXPECT_TRUE(contains(refused("z%s.gz 0 1 1\n"), "does not exist"));
  EXPECT_TRUE(contains(refused("LIST\nz0.gz\n"), "cut short"));
}

TEST_F(VolumeFile, FilePatternsCountDownAndPadWithZeros) {
  const std::string bytes = voxels<std::int16_t>();
  std::size_t first = 0;
  for (const char* name : {"s100.raw", "s055.raw", "s010.raw"}) {
    write(name, bytes.substr(first, 16));
    first += 16;
  }
  expect_voxels(
      read_scan(write("a.nhdr", nrrd("encoding: raw\n" + kPlaced + "data file: s%03d.raw 100 10 -45\n", "")))
          .grid);
}

TEST_F(VolumeFile, ReadsFourDimensionsThatHoldOneVolume) {
  const auto of = [&](const std::string& sizes, const std::string& fields) {
    std::string bytes = nrrd("encoding: raw\n" + fields, voxels<std::int16_t>());
    bytes.replace(bytes.find("dimension: 3\nsizes: 4 3 2"), 25, "dimension: 4\nsizes: " + sizes);
    return write("a.nrrd", bytes);
  };
  const std::string axes = "(0,0.5,0) (0,0,0.25) (2,0,0)";
  for (const auto& [sizes, fields] :
       {std::pair<std::string, std::string>{"4 3 2 1", "space directions: " + axes + " none\n"},
        {"1 4 3 2", "space directions: none " + axes + "\nkinds: list domain domain domain\n"},
        {"4 3 1 2", "space directions: (0,0.5,0) (0,0,0.25) none (2,0,0)\n"}}) {
    const Scan scan = read_scan(of(sizes, "space: LPS\nspace origin: (1,-2,3)\n" + fields));
    expect_voxels(scan.grid);
    EXPECT_TRUE(
        scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(1 + 6, -2 + 0.5, 3 + 0.5)));
  }
  EXPECT_TRUE(read_scan(of("4 3 2 1", "spacings: 0.5 0.25 2 nan\nkinds: space space space time\n"))
                  .grid.geometry()
                  .spacing_mm.isApprox(Vec3(0.5, 0.25, 2)));
  expect_voxels(read_scan(of("4 3 2 1",
                             "space: LPST\nspace directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) "
                             "(0,0,0,2)\nspace origin: (0,0,0,0)\n"))
                    .grid);
  EXPECT_TRUE(contains(refusal(of("2 3 2 2", "spacings: 1 1 1 1\nkinds: list space space space\n")),
                       "holds 2 volumes or values per voxel"));
  EXPECT_TRUE(contains(refusal(of("4 3 1 2", "space: LPS\nspace directions: none none (1,0,0) (0,1,0)\n")),
                       "2 of its 4 axes"));
  std::string header = mha("", voxels<std::int16_t>());
  header.replace(header.find("NDims = 3\nDimSize = 4 3 2"), 25,
                 "NDims = 4\nDimSize = 4 3 2 1\nElementSpacing = 1 2 3 4\nOffset = 5 6 7 8\n"
                 "TransformMatrix = 0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1");
  const Scan scan = read_scan(write("a.mha", header));
  expect_voxels(scan.grid);
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 1, 1)).isApprox(Vec3(5 + 3, 6 + 1, 7 + 2)));
  header.replace(header.find("4 3 2 1"), 7, "2 3 2 2");
  EXPECT_TRUE(contains(refusal(write("b.mha", header)), "holds 2 volumes"));
}

TEST_F(VolumeFile, MetaImageIsPlacedByItsMatrix) {
  const std::string fields =
      "TransformMatrix = 0 1 0 0 0 1 1 0 0\nOffset = 1 -2 3\nElementSpacing = 0.5 0.25 2\n";
  const Scan scan = read_scan(write("a.mha", mha(fields, voxels<std::int16_t>())));
  expect_voxels(scan.grid);
  EXPECT_EQ(scan.format, "MetaImage");
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(7, -1.5, 3.5)));
  const std::string packed = zipped(voxels<std::int16_t>());
  const std::string size = "CompressedDataSize = " + std::to_string(packed.size()) + "\n";
  expect_voxels(read_scan(write("b.mha", mha(fields + "CompressedData = True\n" + size, packed))).grid);
}

// ITK's rules: fields may be in any order, and unknown ones are ignored.
TEST_F(VolumeFile, ReadsUnusualMetaImageHeaders) {
  const std::string data = voxels<std::int16_t>();
  const std::string odd =
      "\n  \r\n# a comment\nComment = x = y\nElementType = met_short\nelementspacing = 0.5 0.25 2\r\n"
      "DimSize : 4 3 2\nNoField\nOffset=1 -2 3\nndims = 3\nCompressedData = false\n\nELEMENTDATAFILE = "
      "Local\n";
  const Scan scan = read_scan(write("a.mha", odd + data));
  expect_voxels(scan.grid);
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 1, 1)).isApprox(Vec3(1.5, -1.75, 5)));
  std::string text;
  for (int k = 0; k < kDims[2]; ++k)
    for (int j = 0; j < kDims[1]; ++j)
      for (int i = 0; i < kDims[0]; ++i) text += std::to_string(i + 10 * j + 100 * k - 50) + "\n";
  expect_voxels(read_scan(write("b.mha", mha("BinaryData = False\n", text))).grid);
}

TEST_F(VolumeFile, ChecksCompressedDataSizeOfMetaImageIfPresent) {
  const std::string packed = zipped(voxels<std::int16_t>());
  const std::string fields = "CompressedData = True\n";
  expect_voxels(read_scan(write("a.mha", mha(fields, packed))).grid);
  EXPECT_TRUE(
      contains(refusal(write("b.mha", mha(fields + "CompressedDataSize = 9\n", packed))), "states 9 bytes"));
  EXPECT_TRUE(contains(refusal(write("c.mha", mha(fields + "CompressedDataSize = 999\n", packed))),
                       "states 999 bytes"));
  EXPECT_TRUE(
      contains(refusal(write("d.mha", mha(fields, voxels<std::int16_t>()))), "cannot be decompressed"));
}

TEST_F(VolumeFile, ConvertsNiftiFromRasToLps) {
  const Scan scan = read_scan(write("a.nii", Nifti().with(voxels<std::int16_t>())));
  expect_voxels(scan.grid);
  EXPECT_EQ(scan.format, "NIfTI");
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(-7, 1.5, 3.5)));
}

TEST_F(VolumeFile, IgnoresSignsOfNiftiVoxelSizes) {
  const Scan scan = read_scan(
      write("a.nii", Nifti().set<float>(80, -0.5F).set<float>(88, -2.0F).with(voxels<std::int16_t>())));
  expect_voxels(scan.grid);
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(-7, 1.5, 3.5)));
}

TEST_F(VolumeFile, DetachedMetaImageYieldsTheSameVoxels) {
  const std::string packed = zipped(voxels<std::int16_t>());
  write("a.raw", voxels<std::int16_t>());
  write("b.raw", "skip" + voxels<std::int16_t>());
  write("a.zraw", packed);
  for (const char* rest :
       {"ElementDataFile = a.raw\n", "HeaderSize = 4\nElementDataFile = b.raw\n",
        "HeaderSize = -1\nElementDataFile = b.raw\n", "CompressedData = True\nElementDataFile = a.zraw\n"}) {
    SCOPED_TRACE(rest);
    std::string header = mha("", "");
    header.replace(header.find("ElementDataFile"), std::string::npos, rest);
    expect_voxels(read_scan(write("a.mhd", header)).grid);
  }
}

TEST_F(VolumeFile, ReadsCompressedNiftiAndRefusesAnyTruncation) {
  const std::string bytes = Nifti().with(voxels<std::int16_t>());
  const std::filesystem::path path = write_gzip("a.nii.gz", bytes);
  expect_voxels(read_scan(path).grid);
  const auto size = std::filesystem::file_size(path);
  for (auto length = size - 1; length > 0; --length) {
    std::filesystem::resize_file(path, length);
    EXPECT_NE(refusal(path), "") << length << " of " << size;
  }
}

TEST_F(VolumeFile, NiftiSlopeOfZeroKeepsStoredValues) {
  expect_voxels(read_scan(write("a.nii", Nifti().set<float>(116, 5.0F).with(voxels<std::int16_t>()))).grid);
  const Scan scan = read_scan(
      write("b.nii", Nifti().set<float>(112, 2.0F).set<float>(116, 5.0F).with(voxels<std::int16_t>())));
  const VoxelIndex second{1, 0, 0};
  EXPECT_EQ(scan.grid[second], 2 * -49 + 5);
}

TEST_F(VolumeFile, NiftiSlopeOfNanKeepsStoredValuesWithAWarning) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float intercept : {nan, 5.0F, std::numeric_limits<float>::infinity()}) {
    const Scan scan = read_scan(
        write("a.nii", Nifti().set<float>(112, nan).set<float>(116, intercept).with(voxels<std::int16_t>())));
    expect_voxels(scan.grid);
    EXPECT_EQ(scan.warnings.size(), 1u);
  }
  EXPECT_TRUE(contains(refusal(write("b.nii", Nifti().set<float>(112, 2.0F).set<float>(116, nan).with(
                                                  voxels<std::int16_t>()))),
                       "is not finite"));
}

// Not rotated, with the first voxel at (9, 8, 7) in RAS.
Nifti with_qform() {
  return Nifti().set<std::int16_t>(252, 1).set<float>(268, 9).set<float>(272, 8).set<float>(276, 7);
}

TEST_F(VolumeFile, UsesTheQformIfTheSformIsUnusable) {
  const auto expect_qform = [&](const Nifti& nifti, const std::string& warning) {
    const Scan scan = read_scan(write("a.nii", nifti.with(voxels<std::int16_t>())));
    expect_voxels(scan.grid);
    EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 1, 1)).isApprox(Vec3(-9.5, -8.25, 9)));
    ASSERT_EQ(scan.warnings.size(), 1u);
    EXPECT_TRUE(contains(scan.warnings[0], warning)) << scan.warnings[0];
  };
  Nifti zero = with_qform(), unit = with_qform();
  for (int n = 0; n < 12; ++n) {
    zero.set<float>(280 + 4 * n, 0);
    unit.set<float>(280 + 4 * n, n % 5 == 0 ? 1.0F : 0.0F);
  }
  expect_qform(zero, "its sform has an axis of zero length; its qform was used");
  expect_qform(unit, "its sform contradicts the voxel sizes");
  for (const float shear : {0.002F, 0.01F})
    expect_qform(with_qform().set<float>(280, shear), "its sform is sheared; its qform");
  expect_qform(with_qform().set<float>(280, 0.3F), "its sform contradicts the voxel sizes");
  expect_qform(with_qform().set<float>(292, std::numeric_limits<float>::quiet_NaN()), "not finite");
  // Both are valid.
  Nifti elsewhere = with_qform();
  for (const auto& [offset, value] : {std::pair{280, 0.5F},
                                      {284, 0.0F},
                                      {288, 0.0F},
                                      {296, 0.0F},
                                      {300, 0.25F},
                                      {304, 0.0F},
                                      {312, 0.0F},
                                      {316, 0.0F},
                                      {320, 2.0F}})
    elsewhere.set<float>(offset, value);
  const Scan other = read_scan(write("c.nii", elsewhere.with(voxels<std::int16_t>())));
  EXPECT_EQ(other.warnings.at(0), "its sform and qform differ in position; the sform was used");
  // An invalid qform does not matter if the sform is good.
  const Scan scan = read_scan(write("b.nii", with_qform().set<float>(256, 3).with(voxels<std::int16_t>())));
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(-7, 1.5, 3.5)));
}

TEST_F(VolumeFile, CorrectsAShearOfATenthOfADegree) {
  const std::string data = voxels<std::int16_t>();
  const std::string directions =
      "encoding: raw\nspace: LPS\nspace directions: (0.5,0,0) (0.00175,1,0) (0,0,2)\n";
  const auto nrrd_file = write("a.nrrd", nrrd(directions, data));
  const auto mha_file = write("a.mha", mha("TransformMatrix = 1 0 0 0.00175 0.999998 0 0 0 1\n", data));
  const auto nifti_file = write("a.nii", Nifti().set<float>(280, 0.00175F).with(data));
  for (const auto& file : {nrrd_file, mha_file, nifti_file}) {
    const Scan scan = read_scan(file);
    const GridGeometry& geometry = scan.grid.geometry();
    EXPECT_TRUE((geometry.direction.transpose() * geometry.direction).isIdentity(1e-12)) << file;
    const bool named =
        std::any_of(scan.warnings.begin(), scan.warnings.end(), [](const std::string& warning) {
          return contains(warning, "0.1 degrees off right angles") || contains(warning, "0.2 degrees off");
        });
    EXPECT_TRUE(named) << file;
  }
  // The centre stays in place: the shift is half the lean of the second axis, 1 voxel up.
  EXPECT_NEAR(read_scan(nrrd_file).grid.geometry().world_from_voxel(Vec3(1.5, 1, 0.5)).x(), 0.75 + 0.00175,
              1e-9);
  const std::string more = "encoding: raw\nspace: LPS\nspace directions: (1,0,0) (0.005,1,0) (0,0,1)\n";
  EXPECT_TRUE(contains(refusal(write("b.nrrd", nrrd(more, data))), "right angles"));
}

// NIfTI-2 header of the same scan with the layout of nifti2.h.
std::string nifti2(const std::string& magic) {
  std::string bytes(544, '\0');
  const auto set = [&](std::size_t offset, auto value) {
    std::memcpy(bytes.data() + offset, &value, sizeof(value));
  };
  set(0, std::int32_t{540});
  std::memcpy(bytes.data() + 4, magic.data(), magic.size());
  set(12, std::int16_t{4});
  set(14, std::int16_t{16});
  for (const auto& [n, size] : {std::pair{0, 4}, {1, 4}, {2, 3}, {3, 2}, {4, 1}})
    set(16 + 8 * static_cast<std::size_t>(n), std::int64_t{size});
  for (const auto& [n, size] : {std::pair{0, 1.0}, {1, 0.5}, {2, 0.25}, {3, 2.0}})
    set(104 + 8 * static_cast<std::size_t>(n), size);
  set(168, std::int64_t{magic[1] == '+' ? 544 : 0});
  set(348, std::int32_t{1});
  const std::array<double, 12> rows{0, 0, 2, 1, 0.5, 0, 0, -2, 0, 0.25, 0, 3};
  for (std::size_t n = 0; n < rows.size(); ++n) set(400 + 8 * n, rows[n]);
  set(500, std::int32_t{2});
  return bytes;
}

TEST_F(VolumeFile, Nifti2AndFilePairsYieldTheSameScan) {
  const std::string data = voxels<std::int16_t>();
  const auto expect_scan = [&](const std::filesystem::path& path) {
    const Scan scan = read_scan(path);
    expect_voxels(scan.grid);
    EXPECT_EQ(scan.format, "NIfTI");
    EXPECT_TRUE(scan.warnings.empty());
    EXPECT_TRUE(scan.grid.geometry().world_from_voxel(Vec3(1, 2, 3)).isApprox(Vec3(-7, 1.5, 3.5)));
  };
  expect_scan(write("a.nii", nifti2("n+2") + data));
  expect_scan(write_gzip("a.nii.gz", nifti2("n+2") + data));
  std::string pair = Nifti().set<float>(108, 0.0F).with("");
  pair.replace(344, 3, "ni1");
  write("b.img", data);
  expect_scan(write("b.hdr", pair));
  expect_scan(folder_ / "b.img");
  write_gzip("c.img.gz", data);
  expect_scan(write("c.hdr", nifti2("ni2")));
  const auto alone = std::filesystem::path(folder_ / "alone");
  std::filesystem::create_directory(alone);
  std::filesystem::copy_file(folder_ / "b.hdr", alone / "b.hdr");
  EXPECT_TRUE(contains(refusal(alone / "b.hdr"), "its voxels are missing"));
  std::filesystem::copy_file(folder_ / "b.img", alone / "b.img");
  expect_scan(alone);
  EXPECT_TRUE(contains(refusal(write("d.nii", nifti2("n+1") + data)), "neither n+2 nor ni2"));
  // Analyze, NIfTI's predecessor, has the same header without a magic.
  pair.replace(344, 3, std::string(3, '\0'));
  EXPECT_TRUE(contains(refusal(write("b.hdr", pair)), "is Analyze 7.5, not NIfTI"));
  EXPECT_TRUE(contains(refusal(write("e.nii", nifti2("n+2").substr(0, 400))), "cut short in its header"));
}

TEST_F(VolumeFile, RefusesDataTruncatedByOneByte) {
  const std::string data = voxels<std::int16_t>();
  const std::string shorter = data.substr(0, data.size() - 1);
  const std::string packed = zipped(data);
  EXPECT_TRUE(
      contains(refusal(write("a.nrrd", nrrd("encoding: raw\n" + kPlaced, shorter))), "48 bytes, it has 47"));
  EXPECT_TRUE(contains(refusal(write("a.mha", mha("", shorter))), "48 bytes, it has 47"));
  EXPECT_TRUE(
      contains(refusal(write("b.mha", mha("CompressedData = True\n", packed.substr(0, packed.size() - 1)))),
               "cut short"));
  EXPECT_TRUE(contains(refusal(write("a.nii", Nifti().with(shorter))), "48 bytes, it has 47"));
}

TEST_F(VolumeFile, RefusesHugeSizes) {
  std::string bytes = nrrd("encoding: raw\n" + kPlaced, voxels<std::int16_t>());
  bytes.replace(bytes.find("4 3 2"), 5, "9000 9000 9000");
  EXPECT_TRUE(contains(refusal(write("a.nrrd", bytes)), "cut short"));
  bytes = mha("", voxels<std::int16_t>());
  bytes.replace(bytes.find("4 3 2"), 5, "4294967296 4294967296 1");
  EXPECT_TRUE(contains(refusal(write("a.mha", bytes)), "impossible size"));
}

TEST_F(VolumeFile, RefusesNonOrthogonalAxes) {
  const std::string sheared = "encoding: raw\nspace: LPS\nspace directions: (1,0,0) (0.2,1,0) (0,0,1)\n";
  EXPECT_TRUE(contains(refusal(write("a.nrrd", nrrd(sheared, voxels<std::int16_t>()))), "right angles"));
  EXPECT_TRUE(contains(
      refusal(write("a.mha", mha("TransformMatrix = 1 0 0 0.6 0.8 0 0 0 1\n", voxels<std::int16_t>()))),
      "right angles"));
  EXPECT_TRUE(contains(refusal(write("a.nii", Nifti().set<float>(280, 1.0F).with(voxels<std::int16_t>()))),
                       "right angles"));
}

TEST_F(VolumeFile, RefusesDirectionsThatAreNotUnitVectors) {
  for (const char* length : {"0", "1e-200", "0.5", "2", "1e200", "1e308", "nan"}) {
    const std::string field = std::string("TransformMatrix = ") + length + " 0 0 0 1 0 0 0 1\n";
    EXPECT_TRUE(contains(refusal(write("a.mha", mha(field, voxels<std::int16_t>()))), "not of length 1"))
        << length;
  }
  const auto by_qform = Nifti().set<std::int16_t>(252, 1).set<std::int16_t>(254, 0).set<float>(256, 1e30F);
  EXPECT_TRUE(contains(refusal(write("a.nii", by_qform.with(voxels<std::int16_t>()))), "not a rotation"));
}

TEST_F(VolumeFile, RefusesInvalidSpacings) {
  for (const char* spacing : {"0 1 1", "-1 1 1", "nan 1 1", "inf 1 1"}) {
    const std::string fields = std::string("spacings: ") + spacing + "\nencoding: raw\n";
    EXPECT_TRUE(contains(refusal(write("a.nrrd", nrrd(fields, voxels<std::int16_t>()))), "mm apart"))
        << spacing;
    const std::string field = std::string("ElementSpacing = ") + spacing + "\n";
    EXPECT_TRUE(contains(refusal(write("a.mha", mha(field, voxels<std::int16_t>()))), "mm apart")) << spacing;
  }
  EXPECT_TRUE(contains(refusal(write("a.nii", Nifti().set<float>(84, 0.0F).with(voxels<std::int16_t>()))),
                       "mm apart"));
  const std::string directions = "encoding: raw\nspace: LPS\nspace directions: (nan,0,0) (0,1,0) (0,0,1)\n";
  EXPECT_TRUE(contains(refusal(write("b.nrrd", nrrd(directions, voxels<std::int16_t>()))),
                       "an axis that is not finite"));
  EXPECT_TRUE(contains(refusal(write("b.nii", Nifti().set<float>(84, 0.3F).with(voxels<std::int16_t>()))),
                       "different voxel sizes"));
}

TEST_F(VolumeFile, RefusesImplausibleSpacingsAndOrigins) {
  const auto of = [&](const std::string& spacings, const std::string& origin) {
    const std::string fields = "space: LPS\nspace directions: (" + spacings + ",0,0) (0,1,0) (0,0,1)\n" +
                               "space origin: (0," + origin + ",0)\nencoding: raw\n";
    return write("a.nrrd", nrrd(fields, voxels<std::int16_t>()));
  };
  for (const char* spacing : {"0.0009", "100.1", "1e-6", "1e100"})
    EXPECT_TRUE(contains(refusal(of(spacing, "0")), "mm apart")) << spacing;
  for (const char* spacing : {"1e-200", "1e300"}) EXPECT_NE(refusal(of(spacing, "0")), "") << spacing;
  for (const char* origin : {"100001", "-1e300"})
    EXPECT_TRUE(contains(refusal(of("1", origin)), "from its origin")) << origin;
  EXPECT_EQ(read_scan(of("0.001", "-1e5")).grid.geometry().spacing_mm.x(), 0.001);
  EXPECT_EQ(read_scan(of("100", "1e5")).grid.geometry().spacing_mm.x(), 100);
  EXPECT_TRUE(contains(refusal(write("a.mha", mha("ElementSpacing = 1e308 1 1\n", voxels<std::int16_t>()))),
                       "1e+308 mm apart"));
  EXPECT_TRUE(contains(refusal(write("a.nii", Nifti().set<float>(88, 1e-6F).with(voxels<std::int16_t>()))),
                       "mm apart"));
}

// Voxels of which one has the value `odd`.
std::string floats_with(float odd, std::string data = voxels<float>()) {
  std::memcpy(data.data() + 4 * 7, &odd, 4);
  std::string bytes = nrrd("encoding: raw\n" + kPlaced, data);
  return bytes.replace(bytes.find("short"), 5, "float");
}

TEST_F(VolumeFile, RefusesInvalidOrEntirelyMissingDensities) {
  for (const float bad : {std::numeric_limits<float>::infinity(), -1e30f})
    EXPECT_TRUE(contains(refusal(write("a.nrrd", floats_with(bad))), "1 voxels have no valid density"));
  std::string none;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int n = 0; n < 24; ++n) none.append(reinterpret_cast<const char*>(&nan), 4);
  EXPECT_TRUE(contains(refusal(write("a.nrrd", floats_with(nan, none))), "no density at all"));
}

TEST_F(VolumeFile, NanVoxelHasNoDensityAndCausesAWarning) {
  const Scan scan = read_scan(write("a.nrrd", floats_with(std::numeric_limits<float>::quiet_NaN())));
  EXPECT_EQ(scan.grid.voxels_without_density(), 1U);
  EXPECT_FALSE(scan.grid.has_density(7));
  EXPECT_EQ((scan.grid[{3, 1, 0}]), scan.grid.outside_density());
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_TRUE(contains(scan.warnings[0], "1 voxels have no density (NaN)"));
}

TEST_F(VolumeFile, RefusesDataOtherThanASingleGreyVolume) {
  std::string bytes = nrrd("encoding: raw\n" + kPlaced, voxels<std::int16_t>());
  bytes.replace(bytes.find("dimension: 3\nsizes: 4 3 2"), 25, "dimension: 2\nsizes: 4 6");
  EXPECT_TRUE(contains(refusal(write("a.nrrd", bytes)), "2 dimensions"));
  EXPECT_TRUE(contains(refusal(write("a.mha", mha("ElementNumberOfChannels = 3\n", std::string(144, ' ')))),
                       "several values"));
  EXPECT_TRUE(contains(refusal(write("a.nii", Nifti().set<std::int16_t>(40, 4).set<std::int16_t>(48, 2).with(
                                                  std::string(96, ' ')))),
                       "2 volumes"));
  EXPECT_TRUE(contains(refusal(write("b.nii", Nifti().set<std::int16_t>(70, 128).with(std::string(72, ' ')))),
                       "type 128"));
}

TEST_F(VolumeFile, RefusesAFileThatIsNotAScan) {
  EXPECT_TRUE(contains(refusal(folder_ / "none.nrrd"), "none.nrrd: no such file"));
  EXPECT_TRUE(contains(refusal(write("empty.nrrd", "")), "empty.nrrd: is empty"));
  EXPECT_TRUE(contains(refusal(write("text.nrrd", "hello\n")), "is not NRRD"));
  EXPECT_TRUE(contains(refusal(write("text.mha", "hello\n")), "is not MetaImage"));
  EXPECT_TRUE(contains(refusal(write("text.nii", "hello\n")), "header"));
  EXPECT_TRUE(contains(refusal(write("text.txt", "hello\n")), "is not a scan"));
  EXPECT_TRUE(contains(refusal(write("c.nhdr", nrrd("encoding: raw\ndata file: gone.raw\n" + kPlaced, ""))),
                       "gone.raw does not exist"));
}

}  // namespace
}  // namespace osteomill
