#include <array>
#include <cstdint>

#include "tests/support/folder_test.h"
#include "tests/support/generated_dicom.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

class DicomSeries : public testing_support::FolderTest {
 protected:
  void write_slice(const Slice& slice) const {
    ASSERT_TRUE(save(*made_up_slice(slice), folder_ / slice.file, slice.syntax));
  }

  // File names are in reverse order of the positions.
  void write_series(E_TransferSyntax syntax = EXS_LittleEndianExplicit) const {
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

TEST_F(DicomSeries, IsReadFromItsFolderOrOneOfItsFiles) {
  write_series();
  expect_series(read_scan(folder_));
  expect_series(read_scan(folder_ / "f7"));
  EXPECT_TRUE(read_scan(folder_).warnings.empty());
  EXPECT_EQ(read_scan(folder_).format, "DICOM");
}

TEST_F(DicomSeries, OffersSeveralSeriesUnlessOneIsSelected) {
  write_series();
  for (int k = 0; k < 2; ++k)
    write_slice({.file = "m" + std::to_string(k), .k = k, .series = "1.2.5", .modality = "MR"});
  std::vector<SeriesSummary> offered;
  ReadOptions options;
  options.choose_series = [&](const std::vector<SeriesSummary>& series) {
    offered = series;
    return std::string("1");
  };
  expect_series(read_scan(folder_, options));
  ASSERT_EQ(offered.size(), 2u);
  EXPECT_EQ(offered[0].modality, "CT");
  EXPECT_EQ(offered[0].number, "1");
  EXPECT_EQ(offered[0].slices, 4u);
  EXPECT_EQ(offered[0].columns, kColumns);
  EXPECT_EQ(offered[0].rows, kRows);
  EXPECT_NEAR(offered[0].thickness_mm.value(), 0.75, 1e-6);
  EXPECT_EQ(offered[1].modality, "MR");
  EXPECT_EQ(offered[1].slices, 2u);
  struct GivenUp {};
  options.choose_series = [](const auto&) -> std::string { throw GivenUp(); };
  EXPECT_THROW(read_scan(folder_, options), GivenUp);
  // A file selects its series, and so does the number of the series.
  expect_series(read_scan(folder_ / "f7", options));
  options.series = "1";
  expect_series(read_scan(folder_, options));
}

TEST_F(DicomSeries, EveryEncodingYieldsTheSameVoxels) {
  for (const auto syntax : {EXS_LittleEndianImplicit, EXS_BigEndianExplicit, EXS_DeflatedLittleEndianExplicit,
                            EXS_RLELossless, EXS_JPEGLSLossless, EXS_JPEGProcess14SV1}) {
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    write_series(syntax);
    expect_series(read_scan(folder_));
    EXPECT_TRUE(read_scan(folder_).warnings.empty());
  }
}

// Splits every fragment in two; the offset table gives the start of each frame.
void split_fragments(const fs::path& path, bool with_table = true) {
  DcmFileFormat file;
  ASSERT_TRUE(file.loadFile(path.c_str()).good());
  const E_TransferSyntax syntax = file.getDataset()->getOriginalXfer();
  DcmPixelSequence* const sequence = fragments(*file.getDataset(), syntax);
  std::vector<std::vector<unsigned char>> parts;
  std::vector<Uint32> offsets;
  Uint32 offset = 0;
  while (sequence->card() > 1) {
    DcmPixelItem* whole = nullptr;
    ASSERT_TRUE(sequence->remove(whole, 1UL).good());
    const std::vector<unsigned char> bytes = bytes_of(*whole);
    delete whole;
    const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 4 * 2);
    parts.emplace_back(bytes.begin(), middle);
    parts.emplace_back(middle, bytes.end());
    offsets.push_back(offset);
    offset += static_cast<Uint32>(bytes.size() + 2 * 8);
  }
  for (const std::vector<unsigned char>& part : parts) {
    auto* fragment = new DcmPixelItem(DcmTag(DCM_Item, EVR_OB));
    fragment->putUint8Array(part.data(), part.size());
    sequence->insert(fragment);
  }
  DcmPixelItem* table = nullptr;
  sequence->getItem(table, 0);
  const std::size_t bytes = with_table ? offsets.size() * sizeof(Uint32) : 0;
  table->putUint8Array(reinterpret_cast<const Uint8*>(offsets.data()), bytes);
  ASSERT_TRUE(file.saveFile(path.c_str(), syntax).good());
}

TEST_F(DicomSeries, ReadsAFrameSplitIntoFragments) {
  for (const auto syntax : {EXS_RLELossless, EXS_JPEGLSLossless, EXS_JPEGProcess14SV1}) {
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    write_series(syntax);
    split_fragments(folder_ / "f7");
    expect_series(read_scan(folder_));
  }
}

// The decoder continues with damaged data and would return its result.
TEST_F(DicomSeries, RefusesDamagedCompressedPixels) {
  write_series(EXS_JPEGProcess14SV1);
  std::ifstream in(folder_ / "f7", std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  in.close();
  const std::size_t end = bytes.rfind("\xFF\xD9");
  ASSERT_NE(end, std::string::npos);
  std::string shorter = bytes;
  shorter.replace(end - 10, 2, "\xFF\xD9");
  write("f7", shorter);
  EXPECT_TRUE(contains(refusal(folder_), "f7: cannot be decoded"));
  std::string other = bytes;
  const std::string size{"\x00\x05\x00\x07", 4};
  ASSERT_NE(other.find(size), std::string::npos);
  other.replace(other.find(size), 4, {"\x00\x07\x00\x05", 4});
  write("f7", other);
  EXPECT_TRUE(contains(refusal(folder_), "do not match its header"));
  // DCMTK would search endlessly for the image after this marker.
  std::string endless = bytes;
  endless.replace(endless.rfind("\xFF\xD8"), 2, "\xFF\x01");
  write("f7", endless);
  EXPECT_TRUE(contains(refusal(folder_), "do not match its header"));
  endless = bytes;
  endless.replace(endless.find("\xFF\xC3"), 2, "\xFF\xF7");
  write("f7", endless);
  EXPECT_TRUE(contains(refusal(folder_), "do not match its header"));
}

// Returns a file with sequences nested `depth` levels deep.
std::string nested(int depth) {
  std::string bytes = std::string(128, '\0') + "DICM";
  for (int n = 0; n < depth; ++n) {
    bytes += std::string("\x08\x00\x40\x11SQ\0\0\xFF\xFF\xFF\xFF\xFE\xFF\x00\xE0\xFF\xFF\xFF\xFF", 20);
  }
  return bytes;
}

TEST_F(DicomSeries, RefusesUnterminatedSequencesOfAnyDepth) {
  for (const int depth : {10, 1000, 100'000, 500'000}) {
    const fs::path path = write("deep", nested(depth));
    EXPECT_TRUE(contains(refusal(path), "damaged")) << depth;
  }
}

TEST_F(DicomSeries, RefusesAFileOfOnlyTruncatedPixels) {
  const std::string pixels("\xE0\x7F\x10\0OB\0\0\x1C\x51\0\0", 12);
  const fs::path path = write("short", std::string(128, '\0') + "DICM" + pixels + std::string(100, '\0'));
  EXPECT_TRUE(contains(refusal(path), "cut short or damaged"));
}

TEST_F(DicomSeries, RefusesASeriesWithAMissingSlice) {
  write_series();
  fs::remove(folder_ / "f7");
  EXPECT_TRUE(contains(refusal(folder_), "a slice is missing"));
}

TEST_F(DicomSeries, RefusesOrWarnsOfASliceTruncatedToAnyLength) {
  for (const auto syntax : {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit, EXS_RLELossless}) {
    write_series(syntax);
    const auto size = fs::file_size(folder_ / "f9");
    for (auto length = size - 1; length > 0; --length) {
      fs::resize_file(folder_ / "f9", length);
      // A file too short to be recognised as DICOM is left out with a warning, like any other file.
      std::string said = refusal(folder_);
      if (said.empty()) said = read_scan(folder_).warnings.empty() ? "" : read_scan(folder_).warnings.front();
      ASSERT_FALSE(said.empty()) << length << " of " << size;
    }
  }
}

TEST_F(DicomSeries, SkipsOtherFilesAndLocalizersWithAWarning) {
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

Scan read_series(const fs::path& path, const std::string& series) {
  return read_scan(path, {.series = series});
}

TEST_F(DicomSeries, ReadsTheLargestCtUnlessASeriesIsChosen) {
  write_series();
  fs::create_directories(folder_ / "more" / "deep");
  for (int k = 0; k < 3; ++k)
    write_slice({.file = "more/deep/a" + std::to_string(k), .k = k, .series = "1.2.40"});
  for (int k = 0; k < 6; ++k)
    write_slice({.file = "more/m" + std::to_string(k), .k = k, .series = "1.2.5", .modality = "MR"});
  const Scan scan = read_scan(folder_);
  expect_series(scan);
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_EQ(
      scan.warnings[0],
      "holds 3 series; the largest CT was read, 1: CT \"made up\", 7 x 5 x 4, 0.5 x 0.25 x 0.75 mm, from "
      "f6, 1.2.3");
  ASSERT_EQ(scan.series.size(), 3U);
  EXPECT_TRUE(contains(scan.series[1], "2: CT \"made up\", 7 x 5 x 3"));
  EXPECT_TRUE(contains(scan.series[2], "3: MR \"made up\", 7 x 5 x 6"));
  for (const auto& [wanted, slices] : {std::pair{"1", 4}, {"2", 3}, {"3", 6}, {"1.2.40", 3}, {"1.2.5", 6}}) {
    const Scan chosen = read_series(folder_, wanted);
    EXPECT_EQ(chosen.grid.geometry().dims[2], slices) << wanted;
    EXPECT_FALSE(contains(chosen.warnings.empty() ? "" : chosen.warnings[0], "series")) << chosen.warnings[0];
  }
  for (const char* wanted : {"4", "0", "1.2", "9.9"}) {
    EXPECT_THROW(read_series(folder_, wanted), InputError) << wanted;
  }
  // The path of a file selects its own series.
  EXPECT_EQ(read_scan(folder_ / "more/deep/a1").grid.geometry().dims[2], 3);
  EXPECT_THROW(read_series(folder_ / "more/deep/a1", "1.2.5"), InputError);
}

TEST_F(DicomSeries, OffersTimePointsOfASeriesSeparately) {
  write_series();
  for (int k = 0; k < 4; ++k) {
    const auto slice = made_up_slice({.k = k, .instance = "1.2.9." + std::to_string(k)});
    slice->getDataset()->putAndInsertString(DCM_TemporalPositionIdentifier, "2");
    put_pixels(*slice->getDataset(), stored_values(k + 20), 16);
    ASSERT_TRUE(save(*slice, folder_ / ("z" + std::to_string(k)), EXS_LittleEndianExplicit));
  }
  const Scan scan = read_scan(folder_);
  expect_series(scan);
  ASSERT_EQ(scan.series.size(), 2U);
  EXPECT_TRUE(contains(scan.series[1], "1.2: CT \"made up\", temporal position 2, 7 x 5 x 4"))
      << scan.series[1];
  ASSERT_EQ(scan.warnings.size(), 1U);
  EXPECT_TRUE(contains(scan.warnings[0], "1.1 was read")) << scan.warnings[0];
  for (const Scan& other : {read_series(folder_, "1.2"), read_scan(folder_ / "z1")})
    EXPECT_EQ((other.grid[{0, 0, 0}]), 2 * 2000 - 100);
  expect_series(read_series(folder_, "1"));
  expect_series(read_scan(folder_ / "f8"));
  EXPECT_THROW(read_series(folder_, "1.3"), InputError);
  // A series that is not a volume is skipped.
  for (const int k : {4, 7, 8}) {
    const auto slice = made_up_slice({.k = k, .instance = "1.2.9." + std::to_string(k)});
    slice->getDataset()->putAndInsertString(DCM_TemporalPositionIdentifier, "2");
    ASSERT_TRUE(save(*slice, folder_ / ("z" + std::to_string(k)), EXS_LittleEndianExplicit));
  }
  expect_series(read_scan(folder_));
}

TEST_F(DicomSeries, SkipsAnOddPictureAndNamesItInAWarning) {
  write_series();
  write_slice({.file = "turned", .k = 9, .instance = "1.2.9.1"});
  DcmFileFormat file;
  ASSERT_TRUE(file.loadFile((folder_ / "turned").c_str()).good());
  file.getDataset()->putAndInsertString(DCM_ImageOrientationPatient, "0\\1\\0\\0\\0\\1");
  ASSERT_TRUE(save(file, folder_ / "turned", EXS_LittleEndianExplicit));
  expect_series(read_scan(folder_));
  EXPECT_EQ(read_scan(folder_).warnings.at(0), "1 picture left out: turned, of another orientation");
  EXPECT_TRUE(contains(refusal(folder_ / "turned"), "turned: is a separate picture"));
  // Reports in colour or without a position are left out too.
  file.getDataset()->putAndInsertString(DCM_PhotometricInterpretation, "RGB");
  ASSERT_TRUE(save(file, folder_ / "turned", EXS_LittleEndianExplicit));
  expect_series(read_scan(folder_));
  EXPECT_EQ(read_scan(folder_).warnings.at(0), "1 picture left out: turned, a colour image (RGB)");
  file.getDataset()->putAndInsertString(DCM_PhotometricInterpretation, "MONOCHROME2");
  for (const DcmTagKey& tag : {DCM_ImageOrientationPatient, DCM_ImagePositionPatient, DCM_PixelSpacing})
    file.getDataset()->findAndDeleteElement(tag);
  ASSERT_TRUE(save(file, folder_ / "turned", EXS_LittleEndianExplicit));
  expect_series(read_scan(folder_));
  EXPECT_EQ(read_scan(folder_).warnings.at(0), "1 picture left out: turned, a picture without a position");
  // Without that file, a slice is missing.
  fs::remove(folder_ / "turned");
  write_slice({.file = "f7", .k = 2, .image_type = "ORIGINAL\\PRIMARY\\LOCALIZER"});
  EXPECT_TRUE(contains(refusal(folder_), "a slice is missing"));
}

// Folder of a disc: upper-case names, nested directory records.
TEST_F(DicomSeries, ReadsTheFilesThatADicomdirLists) {
  fs::create_directories(folder_ / "IMAGES" / "S1");
  fs::create_directories(folder_ / "images2");
  DcmFileFormat directory;
  auto* records = new DcmSequenceOfItems(DCM_DirectoryRecordSequence);
  const auto add = [&](const char* type, const std::string& file) {
    auto* record = new DcmItem;
    record->putAndInsertString(DCM_DirectoryRecordType, type);
    if (!file.empty()) record->putAndInsertString(DCM_ReferencedFileID, file.c_str());
    records->append(record);
  };
  add("PATIENT", "");
  for (int k = 0; k < 4; ++k) {
    write_slice({.file = "IMAGES/S1/I" + std::to_string(k), .k = k});
    add("IMAGE", "IMAGES\\S1\\I" + std::to_string(k));
  }
  // One file that is not listed and must be ignored; others in lower case, as some systems show them.
  write_slice({.file = "IMAGES/S1/OTHER", .k = 9});
  for (int k = 0; k < 2; ++k) {
    write_slice({.file = "images2/i" + std::to_string(k), .k = k, .series = "1.2.9"});
    add("IMAGE", "IMAGES2\\I" + std::to_string(k));
  }
  directory.getDataset()->insert(records);
  directory.getDataset()->putAndInsertString(DCM_SOPClassUID, UID_MediaStorageDirectoryStorage);
  directory.getDataset()->putAndInsertString(DCM_SOPInstanceUID, "1.2.3.4");
  const fs::path dicomdir = folder_ / "DICOMDIR";
  ASSERT_TRUE(directory.saveFile(dicomdir.c_str(), EXS_LittleEndianExplicit).good());
  expect_series(read_scan(dicomdir));
  EXPECT_EQ(read_scan(dicomdir).series.size(), 2U);
  EXPECT_EQ(read_series(dicomdir, "2").grid.geometry().dims[2], 2);
  fs::remove(folder_ / "IMAGES" / "S1" / "I2");
  EXPECT_TRUE(contains(refusal(dicomdir), "DICOMDIR: lists IMAGES/S1/I2, which does not exist"));
}

// Enhanced CT: all frames in one file, each with its own position and rescaling.
TEST_F(DicomSeries, PlacesEnhancedFramesByTheirFunctionalGroups) {
  DcmFileFormat file;
  DcmDataset& data = *file.getDataset();
  write_slice({.file = "one"});
  ASSERT_TRUE(file.loadFile((folder_ / "one").c_str()).good());
  for (const DcmTagKey& tag : {DCM_ImagePositionPatient, DCM_ImageOrientationPatient, DCM_PixelSpacing,
                               DCM_RescaleSlope, DCM_RescaleIntercept})
    data.findAndDeleteElement(tag);
  const auto put = [&](const DcmTagKey& group, int frame, const DcmTagKey& tag, const std::string& text) {
    const bool shared = frame < 0;
    DcmItem* outer = nullptr;
    DcmItem* inner = nullptr;
    ASSERT_TRUE(data.findOrCreateSequenceItem(
                        shared ? DCM_SharedFunctionalGroupsSequence : DCM_PerFrameFunctionalGroupsSequence,
                        outer, shared ? 0 : frame)
                    .good());
    ASSERT_TRUE(outer->findOrCreateSequenceItem(group, inner, 0).good());
    inner->putAndInsertString(tag, text.c_str());
  };
  put(DCM_PixelMeasuresSequence, -1, DCM_PixelSpacing, "0.25\\0.5");
  put(DCM_PlaneOrientationSequence, -1, DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0");
  std::vector<Uint16> pixels;
  // The frames are not in order of position, and one has another slope.
  const std::array<int, 4> place_of_frame{2, 0, 3, 1};
  for (int frame = 0; frame < 4; ++frame) {
    const int k = place_of_frame[static_cast<std::size_t>(frame)];
    put(DCM_PlanePositionSequence, frame, DCM_ImagePositionPatient, "1\\2\\" + std::to_string(10 + 0.75 * k));
    put(DCM_PixelValueTransformationSequence, frame, DCM_RescaleSlope, k == 3 ? "1" : "2");
    put(DCM_PixelValueTransformationSequence, frame, DCM_RescaleIntercept, "-100");
    put(DCM_PixelValueTransformationSequence, frame, DCM_RescaleType, "HU");
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i)
        pixels.push_back(static_cast<Uint16>((k == 3 ? 2 : 1) * stored_value(i, j, k)));
    }
  }
  data.putAndInsertString(DCM_NumberOfFrames, "4");
  data.putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
  for (const auto syntax : {EXS_LittleEndianExplicit, EXS_RLELossless, EXS_JPEGLSLossless}) {
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    ASSERT_TRUE(data.chooseRepresentation(syntax, nullptr).good());
    ASSERT_TRUE(file.saveFile((folder_ / "many").c_str(), syntax).good());
    expect_series(read_scan(folder_ / "many"));
    EXPECT_TRUE(read_scan(folder_ / "many").in_hounsfield_units);
    if (syntax == EXS_LittleEndianExplicit) continue;
    split_fragments(folder_ / "many");
    expect_series(read_scan(folder_ / "many"));
    split_fragments(folder_ / "many", false);
    EXPECT_TRUE(contains(refusal(folder_ / "many"), "which of its fragments"));
  }
  // First of two files of a split image.
  data.putAndInsertString(DCM_ConcatenationUID, "1.2.3.9");
  data.putAndInsertUint16(DCM_InConcatenationNumber, 1);
  data.putAndInsertUint16(DCM_InConcatenationTotalNumber, 2);
  ASSERT_TRUE(file.saveFile((folder_ / "many").c_str(), EXS_JPEGLSLossless).good());
  EXPECT_EQ(read_scan(folder_ / "many").warnings.at(0), "is incomplete: 1 of the 2 files of its image");
  put(DCM_PixelValueTransformationSequence, 0, DCM_RescaleType, "ML_100G");
  ASSERT_TRUE(file.saveFile((folder_ / "many").c_str(), EXS_JPEGLSLossless).good());
  EXPECT_FALSE(read_scan(folder_ / "many").in_hounsfield_units);
}

TEST_F(DicomSeries, RefusesAScanAboveTheMemoryLimit) {
  write_series();
  EXPECT_NO_THROW(read_scan(folder_, {.series = "", .max_memory_bytes = 4 * kColumns * kRows * 4}));
  try {
    read_scan(folder_, {.series = "", .max_memory_bytes = 4 * kColumns * kRows * 4 - 1});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "for its voxels, over the")) << error.what();
  }
  // A file longer than the limit is refused too.
  fs::resize_file(folder_ / "f7", 10'000'000'000);
  try {
    read_scan(folder_, {.series = "", .max_memory_bytes = 1'000'000'000});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "f7: is 10 GB long, over the limit of 1 GB")) << error.what();
  }
}

TEST_F(DicomSeries, RefusesTwoImagesAtOnePositionButNotACopy) {
  write_series();
  fs::copy_file(folder_ / "f7", folder_ / "copy");
  expect_series(read_scan(folder_));
  EXPECT_TRUE(contains(read_scan(folder_).warnings.front(), "copy"));
  // A copy under another name is not another image.
  write_slice({.file = "other", .k = 2, .instance = "1.2.3.98"});
  expect_series(read_scan(folder_));
  write_slice({.file = "other", .k = 2, .instance = "1.2.3.98", .slope = "3"});
  EXPECT_TRUE(contains(refusal(folder_), "one position"));
}

TEST_F(DicomSeries, CorrectsAGantryTilt) {
  for (int k = 0; k < 4; ++k) {
    const std::string position = "1\\" + std::to_string(2 + 0.25 * k) + "\\" + std::to_string(10 + 0.75 * k);
    write_slice({.file = "f" + std::to_string(k), .k = k, .position = position});
  }
  const Scan scan = read_scan(folder_);
  EXPECT_TRUE(contains(scan.warnings.front(), "tilted by 18.4 degrees"));
  ASSERT_EQ(scan.grid.geometry().dims, (std::array<int, 3>{kColumns, kRows + 3, 4}));
  // The drift is one pixel per slice, so that interpolation is exact.
  const VoxelIndex moved{3, 1 + 2, 2};
  EXPECT_NEAR(static_cast<double>(scan.grid[moved]), 2 * stored_value(3, 1, 2) - 100, 1e-3);
}

TEST_F(DicomSeries, PaddingVoxelsHaveNoDensity) {
  struct Case {
    int is_signed;
    int bits;
    int padding;
    int limit;
    // Padding values in the two corners of every slice.
    int first;
    int last;
  };
  // A value beyond the stored bits; a negative one, signed or unsigned; and a range in either direction.
  for (const Case& of : {Case{0, 16, 63536, 0, 63536, 63536}, Case{0, 12, 63536, 0, 63536, 63536},
                         Case{1, 16, 63536, 0, -2000, -2000}, Case{1, 12, -2000, 0, -2000, 2096},
                         Case{0, 16, 65000, 65010, 65000, 65010}, Case{0, 16, 65010, 65000, 65005, 65010},
                         Case{1, 16, -2010, -2000, -2010, -2000}}) {
    for (int k = 0; k < 4; ++k) {
      const auto slice = made_up_slice({.k = k, .bits = of.bits});
      DcmDataset& data = *slice->getDataset();
      std::vector<int> values = stored_values(k);
      values.front() = of.first;
      values.back() = of.last;
      put_pixels(data, values, 16);
      data.putAndInsertUint16(DCM_PixelRepresentation, static_cast<Uint16>(of.is_signed));
      data.putAndInsertUint16(DCM_PixelPaddingValue, static_cast<Uint16>(of.padding));
      if (of.limit != 0) data.putAndInsertUint16(DCM_PixelPaddingRangeLimit, static_cast<Uint16>(of.limit));
      ASSERT_TRUE(save(*slice, folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
    }
    SCOPED_TRACE(std::to_string(of.padding) + " in " + std::to_string(of.bits) + " bits");
    const Scan scan = read_scan(folder_);
    EXPECT_EQ(scan.grid.voxels_without_density(), 8U);
    for (int k = 0; k < 4; ++k) {
      for (const VoxelIndex& v : {VoxelIndex{0, 0, k}, VoxelIndex{kColumns - 1, kRows - 1, k}}) {
        EXPECT_FALSE(scan.grid.has_density(scan.grid.linear_index(v)));
        EXPECT_EQ(scan.grid[v], 2 * stored_value(1, 0, 0) - 100);
      }
      EXPECT_EQ((scan.grid[{3, 2, k}]), 2 * stored_value(3, 2, k) - 100);
    }
  }
}

std::vector<Float64> stored_floats(int k) {
  const std::vector<int> values = stored_values(k);
  return {values.begin(), values.end()};
}

TEST_F(DicomSeries, ReadsFloatAndDoublePixels) {
  for (const bool is_double : {false, true}) {
    for (int k = 0; k < 4; ++k) {
      std::vector<Float64> values = stored_floats(k);
      if (k == 2) values[2] = -7.5;
      const auto slice = made_up_float_slice(k, values, is_double);
      DcmDataset& data = *slice->getDataset();
      if (is_double)
        data.putAndInsertFloat64(DCM_DoubleFloatPixelPaddingValue, -7.5);
      else
        data.putAndInsertFloat32(DCM_FloatPixelPaddingValue, -7.5F);
      ASSERT_TRUE(save(*slice, folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
    }
    const Scan scan = read_scan(folder_);
    EXPECT_EQ(scan.grid.voxels_without_density(), 1U);
    EXPECT_EQ((scan.grid[{3, 2, 3}]), 2 * stored_value(3, 2, 3) - 100);
    fs::resize_file(folder_ / "f1", fs::file_size(folder_ / "f1") - 8);
    EXPECT_TRUE(contains(refusal(folder_), "f1: is cut short"));
  }
}

// Makes a file state a transfer syntax that it does not have.
void say_syntax(const fs::path& path, const std::string& said) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  in.close();
  const std::size_t at = bytes.find(std::string("\x02\0\x10\0UI", 6));
  ASSERT_NE(at, std::string::npos);
  const auto length = static_cast<unsigned char>(bytes[at + 6]);
  ASSERT_LE(said.size(), length);
  std::string padded = said;
  padded.resize(length, '\0');
  bytes.replace(at + 8, length, padded);
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST_F(DicomSeries, ReadsUncompressedSlicesThatStateAWrongSyntax) {
  for (const auto& [has, said] : {std::pair{EXS_LittleEndianImplicit, UID_LittleEndianImplicitTransferSyntax},
                                  {EXS_LittleEndianExplicit, UID_LittleEndianImplicitTransferSyntax},
                                  {EXS_BigEndianExplicit, UID_LittleEndianExplicitTransferSyntax}}) {
    write_series(has);
    for (int k = 0; k < 4; ++k) say_syntax(folder_ / ("f" + std::to_string(9 - k)), said);
    expect_series(read_scan(folder_));
  }
}

// Rewrites the data set of slice k, which has compressed pixels, with implicit value representations.
void make_implicit(const fs::path& path, int k) {
  DcmFileFormat file;
  ASSERT_TRUE(file.loadFile(path.c_str()).good());
  DcmDataset& data = *file.getDataset();
  const DcmXfer syntax(data.getOriginalXfer());
  DcmPixelItem* item = nullptr;
  fragments(data, syntax.getXfer())->getItem(item, 1);
  const std::vector<unsigned char> stream = bytes_of(*item);
  ASSERT_TRUE(save(*made_up_slice({.k = k}), path, EXS_LittleEndianImplicit));
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  in.close();
  bytes.resize(bytes.rfind(std::string("\xE0\x7F\x10\0", 4)) + 4);
  const auto add = [&](const std::string& tag, std::uint32_t length) {
    bytes += tag;
    for (int n = 0; n < 4; ++n) bytes += static_cast<char>(length >> 8 * n);
  };
  add("", 0xFFFFFFFF);
  add(std::string("\xFE\xFF\0\xE0", 4), 0);
  add(std::string("\xFE\xFF\0\xE0", 4), static_cast<std::uint32_t>(stream.size()));
  bytes.append(stream.begin(), stream.end());
  add("\xFE\xFF\xDD\xE0", 0);
  const std::string plain = std::string("\x12\0", 2) + UID_LittleEndianImplicitTransferSyntax;
  const std::size_t at = bytes.find(plain);
  ASSERT_NE(at, std::string::npos);
  std::string uid = syntax.getXferID();
  if (uid.size() % 2 != 0) uid += '\0';
  bytes.replace(at, plain.size() + 1, std::string{static_cast<char>(uid.size()), '\0'} + uid);
  // Length of the meta group.
  const std::size_t group = bytes.find(std::string("\x02\0\0\0UL\x04\0", 8)) + 8;
  bytes[group] = static_cast<char>(bytes[group] + static_cast<char>(uid.size()) - 18);
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST_F(DicomSeries, ReadsCompressedPixelsInAnImplicitDataSet) {
  for (const auto syntax : {EXS_RLELossless, EXS_JPEGLSLossless, EXS_JPEGProcess14SV1}) {
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    write_series(syntax);
    for (int k = 0; k < 4; ++k) make_implicit(folder_ / ("f" + std::to_string(9 - k)), k);
    expect_series(read_scan(folder_));
  }
}

TEST_F(DicomSeries, RefusesAnUnsupportedTransferSyntaxByName) {
  // None is longer than the UID in the file.
  for (const auto& [uid, name] :
       {std::pair{"1.2.840.10008.1.2.4.92", "(1.2.840.10008.1.2.4.92), which is not"},
        {"1.2.840.113619.5.2", "a private syntax of GE (1.2.840.113619.5.2)"},
        {"1.2.3.4", "an unknown transfer syntax (1.2.3.4)"},
        {"1.2\xE4\x1B", "an unknown transfer syntax (1.2\xC3\xA4?)"}}) {
    write_series();
    write_slice({.file = "f7", .k = 2, .syntax = EXS_JPEGProcess14SV1});
    say_syntax(folder_ / "f7", uid);
    const std::string said = refusal(folder_);
    EXPECT_TRUE(contains(said, "f7: is encoded as") && contains(said, name)) << said;
  }
}

TEST_F(DicomSeries, ReadsASignedStreamDespiteAnUnsignedHeader) {
  for (const bool is_signed : {true, false}) {
    for (int k = 0; k < 4; ++k) {
      const auto slice = made_up_slice({.k = k, .bits = 16});
      std::vector<int> values = stored_values(k);
      if (is_signed) values.front() = -1000;
      const std::vector<unsigned char> stream = jpeg2000_stream(values, kColumns, kRows, 16, is_signed);
      put_fragment(*slice->getDataset(), EXS_JPEG2000LosslessOnly, stream);
      ASSERT_TRUE(
          slice->saveFile((folder_ / ("f" + std::to_string(k))).c_str(), EXS_JPEG2000LosslessOnly).good());
    }
    const Scan scan = read_scan(folder_);
    EXPECT_EQ((scan.grid[{0, 0, 0}]), is_signed ? 2 * -1000 - 100 : -100);
    EXPECT_EQ((scan.grid[{3, 2, 3}]), 2 * stored_value(3, 2, 3) - 100);
    EXPECT_EQ(scan.warnings.size(), is_signed ? 1U : 0U);
    if (is_signed) {
      EXPECT_TRUE(contains(scan.warnings.at(0), "read as signed"));
    }
  }
}

TEST_F(DicomSeries, PlacesFramesWithoutPositionsAlongTheNormal) {
  bool with_groups = false;
  const auto write = [&](const DcmTagKey& tag, const std::string& text, const std::string& orientation) {
    const auto file = made_up_slice({});
    DcmDataset& data = *file->getDataset();
    std::vector<int> values;
    for (int k = 0; k < 3; ++k) {
      for (const int value : stored_values(k)) values.push_back(value);
    }
    put_pixels(data, values, 12);
    data.putAndInsertString(DCM_NumberOfFrames, "3");
    data.putAndInsertString(DCM_ImageOrientationPatient, orientation.c_str());
    data.putAndInsertString(tag, text.c_str());
    for (int frame = 0; frame < 3 && with_groups; ++frame) {
      DcmItem* groups = nullptr;
      ASSERT_TRUE(data.findOrCreateSequenceItem(DCM_PerFrameFunctionalGroupsSequence, groups, frame).good());
    }
    ASSERT_TRUE(save(*file, folder_ / "many", EXS_LittleEndianExplicit));
  };
  for (const auto& [tag, text] : {std::pair{DCM_SpacingBetweenSlices, std::string("0.75")},
                                  {DCM_SliceLocationVector, "5\\5.75\\6.5"},
                                  {DCM_SpacingBetweenSlices, "0.75"}}) {
    write(tag, text, "0\\1\\0\\0\\0\\1");
    const Scan scan = read_scan(folder_ / "many");
    EXPECT_EQ(scan.grid.geometry().dims, (std::array<int, 3>{kColumns, kRows, 3}));
    EXPECT_NEAR(scan.grid.geometry().spacing_mm.z(), 0.75, 1e-9);
    EXPECT_TRUE(scan.grid.geometry().direction.col(2).isApprox(Vec3::UnitX()));
    EXPECT_EQ((scan.grid[{3, 2, 2}]), 2 * stored_value(3, 2, 2) - 100);
    EXPECT_TRUE(contains(scan.warnings.at(0), "the second 0.75 mm from the first"));
    // Functional groups need not contain the position either.
    with_groups = tag == DCM_SliceLocationVector;
  }
  // With a negative spacing, the last slice is lowest.
  write(DCM_SpacingBetweenSlices, "-0.75", "1\\0\\0\\0\\1\\0");
  EXPECT_EQ((read_scan(folder_ / "many").grid[{3, 2, 0}]), 2 * stored_value(3, 2, 2) - 100);
  write(DCM_SpacingBetweenSlices, "0", "1\\0\\0\\0\\1\\0");
  EXPECT_TRUE(contains(refusal(folder_ / "many"), "one position"));
  write(DCM_SliceThickness, "0.75", "1\\0\\0\\0\\1\\0");
  EXPECT_TRUE(contains(refusal(folder_ / "many"), "several frames without positions"));
  write(DCM_FrameIncrementPointer, "(0018,1063)", "1\\0\\0\\0\\1\\0");
  EXPECT_TRUE(contains(refusal(folder_ / "many"), "several frames ordered by FrameTime"));
}

TEST_F(DicomSeries, IgnoresDataAfterThePixels) {
  write_series();
  // Sparse file: only reading all of it would take long.
  fs::resize_file(folder_ / "f7", 1'000'000'000);
  expect_series(read_scan(folder_));
}

// Returns the number of bytes this process has read from files.
std::uint64_t bytes_read() {
  std::ifstream io("/proc/self/io");
  std::string word;
  std::uint64_t bytes = 0;
  io >> word >> bytes;
  EXPECT_EQ(word, "rchar:");
  return bytes;
}

TEST_F(DicomSeries, DoesNotReadDataAfterFloatPixels) {
  for (const bool is_double : {false, true}) {
    for (int k = 0; k < 4; ++k) {
      const auto slice = made_up_float_slice(k, stored_floats(k), is_double);
      ASSERT_TRUE(save(*slice, folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
    }
    // Too short for items to be counted.
    const std::string zeros(2'000'000, '\0');
    std::ofstream(folder_ / "f2", std::ios::binary | std::ios::app) << zeros;
    const std::uint64_t before = bytes_read();
    expect_series(read_scan(folder_));
    EXPECT_LT(bytes_read() - before, zeros.size() / 2);
    // Trailing data other than zeros, which would be taken for damaged elements.
    std::ofstream(folder_ / "f2", std::ios::binary | std::ios::app) << "no element";
    expect_series(read_scan(folder_));
  }
}

TEST_F(DicomSeries, WarnsOfDensitiesOutsideTheRangeOfCt) {
  const auto warnings = [&](int value, int is_signed, const std::string& modality) {
    for (int k = 0; k < 4; ++k) {
      const auto slice = made_up_slice({.k = k, .slope = "1", .modality = modality, .bits = 16});
      std::vector<int> values = stored_values(k);
      values.front() = value;
      put_pixels(*slice->getDataset(), values, 16);
      slice->getDataset()->putAndInsertUint16(DCM_PixelRepresentation, static_cast<Uint16>(is_signed));
      EXPECT_TRUE(save(*slice, folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
    }
    return read_scan(folder_).warnings;
  };
  EXPECT_TRUE(
      contains(warnings(64'536, 0, "CT").at(0), "has densities from -99 to 64436, outside the range of CT"));
  EXPECT_TRUE(contains(warnings(40'000, 1, "CT").at(0), "from -25636 to"));
  EXPECT_TRUE(warnings(30'810, 0, "CT").empty());
  EXPECT_TRUE(warnings(65'536 - 3024, 1, "CT").empty());
  EXPECT_EQ(warnings(64'536, 0, "MR").size(), 1U);
}

TEST_F(DicomSeries, WarnsOfSlicesOutOfNumericalOrder) {
  const auto warnings = [&](const std::array<const char*, 4>& numbers) {
    for (int k = 0; k < 4; ++k) {
      const auto slice = made_up_slice({.k = k});
      slice->getDataset()->putAndInsertString(DCM_InstanceNumber, numbers[static_cast<std::size_t>(k)]);
      EXPECT_TRUE(save(*slice, folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
    }
    const Scan scan = read_scan(folder_);
    expect_series(scan);
    return scan.warnings;
  };
  EXPECT_TRUE(warnings({"1", "2", "4", "9"}).empty());
  EXPECT_TRUE(warnings({"4", "3", "2", "1"}).empty());
  EXPECT_TRUE(warnings({"1", "3", "2", ""}).empty());
  EXPECT_TRUE(warnings({"7", "7", "7", "7"}).empty());
  EXPECT_TRUE(contains(warnings({"1", "3", "2", "4"}).at(0), "order of their numbers, 1, 3, 2 (f0 to f2)"));
  EXPECT_TRUE(contains(warnings({"1", "1", "2", "2"}).at(0), "order of their numbers, 1, 1, 2"));
}

TEST_F(DicomSeries, ConvertsDescriptionsToUtf8) {
  for (const auto& [set, text, shown] :
       {std::array{"ISO_IR 100",
                   "Sch\xE4"
                   "del",
                   "Sch\xC3\xA4"
                   "del"},
        {"ISO_IR 192", "\xE9\xAA\xA8", "\xE9\xAA\xA8"},
        {"ISO_IR 144", "\xBA\xDE\xE1\xE2\xEC", "\xD0\x9A\xD0\xBE\xD1\x81\xD1\x82\xD1\x8C"},
        {"",
         "Sch\xE4"
         "del",
         "Sch\xC3\xA4"
         "del"},
        {"",
         "Sch\xC3\xA4"
         "del",
         "Sch\xC3\xA4"
         "del"},
        {"ISO_IR 100",
         "a\x1B[31mb\x9B"
         "c\x7F",
         "a?[31mb?c?"},
        {"no such set", "\xE4\x1B", "\xC3\xA4?"},
        {"\\ISO 2022 IR 87", "\x1B$B9|\x1B(B CT", "\xE9\xAA\xA8 CT"},
        {"ISO 2022 IR 13\\ISO 2022 IR 87", "\xC1\xAD\xB3 \x1B$B9|\x1B(J CT",
         "\xEF\xBE\x81\xEF\xBD\xAD\xEF\xBD\xB3 \xE9\xAA\xA8 CT"},
        {"ISO 2022 IR 149", "\x1B$)C\xB5\xCE \x1B[1m", "\xEB\x91\x90 1m"},
        {"ISO 2022 IR 87", "a\x1B$B9", "a?$B9"}}) {
    for (int k = 0; k < 4; ++k) {
      const auto slice = made_up_slice({.k = k, .series = "1.2." + std::to_string(k / 2)});
      slice->getDataset()->putAndInsertString(DCM_SpecificCharacterSet, set);
      slice->getDataset()->putAndInsertString(DCM_SeriesDescription, text);
      ASSERT_TRUE(save(*slice, folder_ / ("f" + std::to_string(k)), EXS_LittleEndianExplicit));
    }
    const std::string line = read_scan(folder_).series.at(0);
    EXPECT_TRUE(contains(line, '"' + std::string(shown) + '"')) << line;
  }
}

TEST_F(DicomSeries, RefusesAFolderWithoutAScan) {
  EXPECT_TRUE(contains(refusal(folder_), "holds no scan: no DICOM slices and no NRRD"));
  write("notes.txt", "hello");
  EXPECT_TRUE(contains(refusal(folder_), "holds no scan: no DICOM slices and no NRRD"));
  fs::create_directories(folder_ / "series");
  EXPECT_TRUE(contains(refusal(folder_), "holds no scan: no DICOM slices and no NRRD"));
  write_slice({.file = "one"});
  EXPECT_TRUE(contains(refusal(folder_), "only one slice"));
  EXPECT_TRUE(contains(refusal(folder_ / "one"), "only one slice"));
}

TEST_F(DicomSeries, RefusesANonImageAndNamesItsModality) {
  const auto file = made_up_slice({.modality = "RTSTRUCT"});
  for (const DcmTagKey& tag : {DCM_PixelData, DCM_Columns, DCM_Rows})
    file->getDataset()->findAndDeleteElement(tag);
  ASSERT_TRUE(save(*file, folder_ / "plan", EXS_LittleEndianExplicit));
  EXPECT_TRUE(contains(refusal(folder_ / "plan"), "plan: is DICOM, but not an image: RTSTRUCT"));
}

TEST_F(DicomSeries, RefusesARescaleSlopeOfZero) {
  write_series();
  write_slice({.file = "f8", .k = 1, .slope = "0"});
  EXPECT_TRUE(contains(refusal(folder_), "f8: has a RescaleSlope of 0"));
}

}  // namespace
}  // namespace osteomill
