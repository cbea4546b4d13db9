#include <cstdint>

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageWriter.h>
#include <gdcmReader.h>
#include <gdcmTrace.h>

#include "osteomill/ct/temporary_folder.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using testing_support::contains;

constexpr int kColumns = 7;
constexpr int kRows = 5;

// One slice of a made-up series; GDCM writes it, so that the reader is not held against itself.
struct Slice {
  std::string file = {};
  int k = 0;
  std::string series = "1.2.3";
  std::string instance = {};
  std::string position = {};
  std::string slope = "2";
  std::string image_type = "ORIGINAL\\PRIMARY\\AXIAL";
  gdcm::TransferSyntax::TSType syntax = gdcm::TransferSyntax::ExplicitVRLittleEndian;
};

void set_text(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element, gdcm::VR::VRType vr,
              std::string text) {
  if (text.size() % 2 != 0) text += vr == gdcm::VR::UI ? '\0' : ' ';
  gdcm::DataElement value(gdcm::Tag(group, element));
  value.SetVR(vr);
  value.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
  data.Replace(value);
}

int stored_value(int i, int j, int k) {
  return i + 10 * j + 100 * k;
}

class DicomSeries : public testing_support::FolderTest {
 protected:
  void write_slice(const Slice& slice) const {
    gdcm::Trace::WarningOff();
    gdcm::ImageWriter writer;
    fill_image(slice, writer.GetImage());
    gdcm::DataSet& data = writer.GetFile().GetDataSet();
    const std::string number = std::to_string(slice.k + 1);
    set_text(data, 0x0008, 0x0008, gdcm::VR::CS, slice.image_type);
    set_text(data, 0x0008, 0x0016, gdcm::VR::UI, "1.2.840.10008.5.1.4.1.1.2");
    set_text(data, 0x0008, 0x0018, gdcm::VR::UI,
             slice.instance.empty() ? slice.series + ".7." + number : slice.instance);
    set_text(data, 0x0008, 0x0060, gdcm::VR::CS, "CT");
    set_text(data, 0x0020, 0x000E, gdcm::VR::UI, slice.series);
    writer.SetFileName((folder_ / slice.file).c_str());
    ASSERT_TRUE(writer.Write());
    rewrite(folder_ / slice.file, slice);
  }

  static void fill_image(const Slice& slice, gdcm::Image& image) {
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, kColumns);
    image.SetDimension(1, kRows);
    image.SetPixelFormat(gdcm::PixelFormat(1, 16, 12, 11, 0));
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetSpacing(0, 0.5);
    image.SetSpacing(1, 0.25);
    std::vector<std::uint16_t> pixels;
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i)
        pixels.push_back(static_cast<std::uint16_t>(stored_value(i, j, slice.k)));
    }
    gdcm::DataElement element(gdcm::Tag(0x7FE0, 0x0010));
    element.SetByteValue(reinterpret_cast<const char*>(pixels.data()),
                         static_cast<std::uint32_t>(2 * pixels.size()));
    image.SetDataElement(element);
    image.SetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
    if (slice.syntax == gdcm::TransferSyntax::ExplicitVRLittleEndian) return;
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(slice.syntax);
    change.SetInput(image);
    ASSERT_TRUE(change.Change());
    image = change.GetOutput();
  }

  // The image writer has its own mind about the place and the values of a slice, so they are set afterwards.
  static void rewrite(const fs::path& file, const Slice& slice) {
    gdcm::Reader reader;
    reader.SetFileName(file.c_str());
    ASSERT_TRUE(reader.Read());
    gdcm::DataSet& data = reader.GetFile().GetDataSet();
    const std::string height = std::to_string(10 + 0.75 * slice.k);
    set_text(data, 0x0020, 0x0032, gdcm::VR::DS, slice.position.empty() ? "1\\2\\" + height : slice.position);
    set_text(data, 0x0020, 0x0037, gdcm::VR::DS, "1\\0\\0\\0\\1\\0");
    set_text(data, 0x0028, 0x0030, gdcm::VR::DS, "0.25\\0.5");
    set_text(data, 0x0028, 0x1052, gdcm::VR::DS, "-100");
    set_text(data, 0x0028, 0x1053, gdcm::VR::DS, slice.slope);
    gdcm::Writer writer;
    writer.CheckFileMetaInformationOff();
    writer.SetFile(reader.GetFile());
    writer.SetFileName(file.c_str());
    ASSERT_TRUE(writer.Write());
  }

  // Names run against the positions.
  void write_series(
      gdcm::TransferSyntax::TSType syntax = gdcm::TransferSyntax::ExplicitVRLittleEndian) const {
    for (int k = 0; k < 4; ++k) write_slice({.file = "f" + std::to_string(9 - k), .k = k, .syntax = syntax});
  }

  static void expect_series(const Scan& scan) {
    const GridGeometry& geometry = scan.grid.geometry();
    ASSERT_EQ(geometry.dims, (std::array<int, 3>{kColumns, kRows, 4}));
    EXPECT_TRUE(geometry.spacing_mm.isApprox(Vec3(0.5, 0.25, 0.75), 1e-6));
    EXPECT_TRUE(geometry.origin_mm.isApprox(Vec3(1, 2, 10), 1e-6));
    EXPECT_TRUE(geometry.direction.isIdentity(1e-9));
    for (int k = 0; k < 4; ++k) {
      for (int j = 0; j < kRows; ++j) {
        for (int i = 0; i < kColumns; ++i) {
          const VoxelIndex v{i, j, k};
          EXPECT_EQ(scan.grid[v], static_cast<float>(2 * stored_value(i, j, k) - 100));
        }
      }
    }
  }
};

TEST_F(DicomSeries, IsReadFromItsFolderAndFromAnyOfItsFiles) {
  write_series();
  expect_series(read_scan(folder_));
  expect_series(read_scan(folder_ / "f7"));
  EXPECT_TRUE(read_scan(folder_).warnings.empty());
  EXPECT_EQ(read_scan(folder_).format, "DICOM");
}

TEST_F(DicomSeries, EveryEncodingGivesTheSame) {
  using Syntax = gdcm::TransferSyntax;
  for (const auto syntax : {Syntax::ImplicitVRLittleEndian, Syntax::RLELossless, Syntax::JPEGLSLossless,
                            Syntax::JPEGLosslessProcess14_1}) {
    SCOPED_TRACE(Syntax::GetTSString(syntax));
    write_series(syntax);
    expect_series(read_scan(folder_));
  }
}

TEST_F(DicomSeries, ASliceThatIsMissingIsNoticed) {
  write_series();
  fs::remove(folder_ / "f7");
  EXPECT_TRUE(contains(refusal(folder_), "a slice is missing"));
}

TEST_F(DicomSeries, EveryLengthToWhichASliceCanBeCutIsNoticed) {
  using Syntax = gdcm::TransferSyntax;
  for (const auto syntax :
       {Syntax::ExplicitVRLittleEndian, Syntax::ImplicitVRLittleEndian, Syntax::RLELossless}) {
    write_series(syntax);
    const auto size = fs::file_size(folder_ / "f9");
    for (auto length = size - 1; length > 0; --length) {
      fs::resize_file(folder_ / "f9", length);
      // Cut to nothing that looks like DICOM it is left out, with a warning: nobody can tell it from other
      // files.
      std::string said = refusal(folder_);
      if (said.empty()) said = read_scan(folder_).warnings.empty() ? "" : read_scan(folder_).warnings.front();
      ASSERT_FALSE(said.empty()) << length << " of " << size;
    }
  }
}

TEST_F(DicomSeries, OtherFilesAndLocalizersAreLeftOutWithAWarning) {
  write_series();
  write("notes.txt", "hello");
  write("DICOMDIR", std::string(128, '\0') + "DICM");
  write_slice(
      {.file = "scout", .k = 0, .instance = "1.2.3.99", .image_type = "ORIGINAL\\PRIMARY\\LOCALIZER"});
  const Scan scan = read_scan(folder_);
  expect_series(scan);
  ASSERT_EQ(scan.warnings.size(), 2U);
  EXPECT_TRUE(contains(scan.warnings[0], "2 files"));
  EXPECT_TRUE(contains(scan.warnings[1], "scout"));
}

TEST_F(DicomSeries, TheLargestOfSeveralSeriesIsReadAndNamed) {
  write_series();
  for (int k = 0; k < 3; ++k) write_slice({.file = "a" + std::to_string(k), .k = k + 5, .series = "1.2.4"});
  const Scan scan = read_scan(folder_);
  expect_series(scan);
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_TRUE(
      contains(scan.warnings[0], "\"1.2.3\" (4 slices, from f6) was read, left out: \"1.2.4\" (3 slices"));
  EXPECT_EQ(read_scan(folder_ / "a1").grid.geometry().dims[2], 3);
}

TEST_F(DicomSeries, TwoImagesAtOnePlaceAreRefusedAndACopyIsNot) {
  write_series();
  fs::copy_file(folder_ / "f7", folder_ / "copy");
  expect_series(read_scan(folder_));
  EXPECT_TRUE(contains(read_scan(folder_).warnings.front(), "copy"));
  write_slice({.file = "other", .k = 2, .instance = "1.2.3.98"});
  EXPECT_TRUE(contains(refusal(folder_), "one position"));
}

TEST_F(DicomSeries, ATiltedGantryIsPutStraight) {
  for (int k = 0; k < 4; ++k) {
    const std::string position = "1\\" + std::to_string(2 + 0.25 * k) + "\\" + std::to_string(10 + 0.75 * k);
    write_slice({.file = "f" + std::to_string(k), .k = k, .position = position});
  }
  const Scan scan = read_scan(folder_);
  EXPECT_TRUE(contains(scan.warnings.front(), "tilted by 18.4 degrees"));
  ASSERT_EQ(scan.grid.geometry().dims, (std::array<int, 3>{kColumns, kRows + 3, 4}));
  // The drift is one pixel a slice, so that nothing is smoothed.
  const VoxelIndex moved{3, 1 + 2, 2};
  EXPECT_NEAR(static_cast<double>(scan.grid[moved]), 2 * stored_value(3, 1, 2) - 100, 1e-3);
}

TEST_F(DicomSeries, AFolderWithoutSlicesIsRefused) {
  EXPECT_TRUE(contains(refusal(folder_), "holds no DICOM slices"));
  write("notes.txt", "hello");
  EXPECT_TRUE(contains(refusal(folder_), "holds no DICOM slices"));
  fs::create_directories(folder_ / "series");
  EXPECT_TRUE(contains(refusal(folder_), "name the folder within it"));
  write_slice({.file = "one"});
  EXPECT_TRUE(contains(refusal(folder_), "only one slice"));
  EXPECT_TRUE(contains(refusal(folder_ / "one"), "only one slice"));
}

TEST_F(DicomSeries, ASlopeOfZeroIsRefused) {
  write_series();
  write_slice({.file = "f8", .k = 1, .slope = "0"});
  EXPECT_TRUE(contains(refusal(folder_), "f8 has a RescaleSlope of 0"));
}

}  // namespace
}  // namespace osteomill
