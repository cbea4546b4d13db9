#include "osteomill/ct/read_labels.h"

#include "fuzz/targets.h"
#include "tests/support/generated_dicom.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;
using namespace testing_support;

namespace {

void save_sound_slice(const fs::path& folder) {
  if (!fs::exists(folder / "sound"))
    save(*made_up_slice({.k = 1}), folder / "sound", EXS_LittleEndianExplicit);
}

// Reads the bytes as a file, beside a valid slice of the same series.
void read_file(Bytes bytes, const fs::path& folder) {
  save_sound_slice(folder);
  write_bytes(folder / "file", bytes);
  read_as_info_does(folder);
}

void read_directory(Bytes bytes, const fs::path& folder) {
  for (int k = 0; k < 2 && !fs::exists(folder / "I1"); ++k)
    save(*made_up_slice({.k = k}), folder / ("I" + std::to_string(k)), EXS_LittleEndianExplicit);
  write_bytes(folder / "DICOMDIR", bytes);
  read_as_info_does(folder / "DICOMDIR");
}

// Returns an enhanced file whose frames have different slopes, the second at `height_mm`.
std::unique_ptr<DcmFileFormat> enhanced(const std::string& height_mm = "9.25") {
  auto file = made_up_slice({});
  DcmDataset& data = *file->getDataset();
  std::vector<int> values = stored_values(0);
  values.insert(values.end(), values.begin(), values.end());
  put_pixels(data, values, 12);
  data.putAndInsertString(DCM_NumberOfFrames, "2");
  for (int frame = 0; frame < 2; ++frame) {
    DcmItem* outer = nullptr;
    DcmItem* inner = nullptr;
    data.findOrCreateSequenceItem(DCM_PerFrameFunctionalGroupsSequence, outer, frame);
    outer->findOrCreateSequenceItem(DCM_PlanePositionSequence, inner);
    inner->putAndInsertString(DCM_ImagePositionPatient, ("1\\2\\" + (frame == 0 ? "10" : height_mm)).c_str());
    outer->findOrCreateSequenceItem(DCM_PixelValueTransformationSequence, inner);
    inner->putAndInsertString(DCM_RescaleSlope, "3");
  }
  return file;
}

std::vector<std::string> file_seeds(const fs::path& folder) {
  std::vector<std::string> seeds;
  // Uneven slice distances, and a tilted gantry.
  save(*enhanced("9.35"), folder / "a", EXS_LittleEndianExplicit);
  seeds.push_back(read_bytes(folder / "a"));
  save(*made_up_slice({.position = "1\\2.25\\10"}), folder / "a", EXS_LittleEndianExplicit);
  seeds.push_back(read_bytes(folder / "a"));
  for (const auto syntax : {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit, EXS_BigEndianExplicit,
                            EXS_RLELossless, EXS_JPEGLSLossless, EXS_JPEGProcess14SV1}) {
    save(*made_up_slice({}), folder / "a", syntax);
    seeds.push_back(read_bytes(folder / "a"));
    save(*enhanced(), folder / "a", syntax);
    seeds.push_back(read_bytes(folder / "a"));
  }
  const std::vector<int> values = stored_values(0);
  for (const bool is_double : {false, true}) {
    save(*made_up_float_slice(0, {values.begin(), values.end()}, is_double), folder / "a",
         EXS_LittleEndianExplicit);
    seeds.push_back(read_bytes(folder / "a"));
  }
  return seeds;
}

// Reads the bytes as a segmentation: as a scan, and as the labels of a scan.
void read_segmentation(Bytes bytes, const fs::path& folder) {
  static const Scan scan = [&] {
    for (int k = 0; k < 4; ++k)
      save(*made_up_slice({.k = k}), folder / ("I" + std::to_string(k)), EXS_LittleEndianExplicit);
    Scan read = read_scan(folder);
    for (int k = 0; k < 4; ++k) fs::remove(folder / ("I" + std::to_string(k)));
    return read;
  }();
  write_bytes(folder / "segmentation", bytes);
  read_labels({folder / "segmentation", "", {}}, scan.grid.geometry(), 1 << 26);
  read_as_info_does(folder / "segmentation");
}

std::vector<std::string> segmentation_seeds(const fs::path& folder) {
  save(*made_up_segmentation(), folder / "a", EXS_LittleEndianExplicit);
  return {read_bytes(folder / "a")};
}

std::vector<std::string> directory_seeds(const fs::path& folder) {
  DcmFileFormat file;
  DcmDataset& data = *file.getDataset();
  data.putAndInsertString(DCM_SOPClassUID, UID_MediaStorageDirectoryStorage);
  data.putAndInsertString(DCM_SOPInstanceUID, "1.2.3.4");
  for (int k = 0; k < 2; ++k) {
    DcmItem* record = nullptr;
    data.findOrCreateSequenceItem(DCM_DirectoryRecordSequence, record, k);
    record->putAndInsertString(DCM_DirectoryRecordType, "IMAGE");
    record->putAndInsertString(DCM_ReferencedFileID, k == 0 ? "I0" : "I1");
  }
  file.saveFile((folder / "a").c_str(), EXS_LittleEndianExplicit);
  return {read_bytes(folder / "a")};
}

// Returns a slice as a file with a deflated data set, split where the deflated data begin.
std::pair<std::string, std::string> deflated_slice(const fs::path& file) {
  constexpr std::size_t kGroupLength = 140, kAfterIt = 144;
  save(*made_up_slice({}), file, EXS_DeflatedLittleEndianExplicit);
  const std::string bytes = read_bytes(file);
  const std::size_t start = kAfterIt + static_cast<unsigned char>(bytes[kGroupLength]) +
                            256U * static_cast<unsigned char>(bytes[kGroupLength + 1]);
  return {bytes.substr(0, start), bytes.substr(start)};
}

// Reads the bytes as the inflated data set.
void read_deflated(Bytes bytes, const fs::path& folder) {
  static const std::string head = deflated_slice(folder / "file").first;
  std::string file = head;
  file.append(bytes.begin(), bytes.end());
  read_file({reinterpret_cast<const unsigned char*>(file.data()), file.size()}, folder);
}

std::vector<std::string> deflated_seeds(const fs::path& folder) {
  return {deflated_slice(folder / "a").second};
}

// Reads the bytes as the compressed pixels of a slice in an otherwise valid series.
auto read_pixels_of(E_TransferSyntax syntax, int bits) {
  return [=](Bytes bytes, const fs::path& folder) {
    save_sound_slice(folder);
    const auto damaged = made_up_slice({.bits = bits});
    put_fragment(*damaged->getDataset(), syntax, bytes);
    damaged->saveFile((folder / "damaged").c_str(), syntax);
    read_as_info_does(folder);
  };
}

std::string text_of(const std::vector<unsigned char>& bytes) {
  return {bytes.begin(), bytes.end()};
}

auto pixel_seeds(E_TransferSyntax syntax, int bits) {
  return [=](const fs::path&) -> std::vector<std::string> {
    register_encoders();
    const auto file = made_up_slice({.bits = bits});
    file->getDataset()->chooseRepresentation(syntax, nullptr);
    DcmPixelItem* item = nullptr;
    fragments(*file->getDataset(), syntax)->getItem(item, 1);
    return {text_of(bytes_of(*item))};
  };
}

std::vector<std::string> jpeg2000_seeds(const fs::path&) {
  std::vector<std::string> seeds;
  for (const float ratio : {0.0F, 3.0F})
    seeds.push_back(text_of(jpeg2000_stream(stored_values(0), kColumns, kRows, 12, false, ratio)));
  return seeds;
}

Target pixels(const char* name, E_TransferSyntax syntax, int bits) {
  return {name, read_pixels_of(syntax, bits), pixel_seeds(syntax, bits)};
}

}  // namespace

// DCMTK has separate JPEG decoders for pixels of up to 8, 12 and 16 bits.
std::vector<Target> dicom_targets() {
  return {{"dicom", read_file, file_seeds},
          {"dicomdir", read_directory, directory_seeds},
          {"deflated", read_deflated, deflated_seeds},
          {"dicom-seg", read_segmentation, segmentation_seeds},
          pixels("rle", EXS_RLELossless, 12),
          pixels("jpeg-lossy-8", EXS_JPEGProcess1, 8),
          pixels("jpeg-lossy-12", EXS_JPEGProcess2_4, 12),
          pixels("jpeg-lossless-8", EXS_JPEGProcess14SV1, 8),
          pixels("jpeg-lossless-12", EXS_JPEGProcess14SV1, 12),
          pixels("jpeg-lossless-16", EXS_JPEGProcess14SV1, 16),
          pixels("jpegls", EXS_JPEGLSLossless, 12),
          pixels("jpegls-lossy", EXS_JPEGLSLossy, 12),
          {"jpeg2000", read_pixels_of(EXS_JPEG2000, 12), jpeg2000_seeds}};
}

}  // namespace osteomill::fuzzing
