#include <array>
#include <memory>

#include "fuzz/targets.h"
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <openjpeg.h>

#include "osteomill/ct/read_scan.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;

namespace {

constexpr int kColumns = 8;
constexpr int kRows = 6;

const ReadOptions kSmall{.series = "", .max_memory_bytes = 1 << 26};

std::vector<Uint16> pixels_of(int k) {
  std::vector<Uint16> pixels;
  for (int n = 0; n < kColumns * kRows; ++n) pixels.push_back(static_cast<Uint16>(n * (k + 1) % 3000));
  return pixels;
}

void register_encoders() {
  static const bool once = [] {
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    DJLSEncoderRegistration::registerCodecs();
    return true;
  }();
  static_cast<void>(once);
}

// A slice of a made-up series of two.
std::unique_ptr<DcmFileFormat> slice(int k) {
  register_encoders();
  auto file = std::make_unique<DcmFileFormat>();
  DcmDataset& data = *file->getDataset();
  const std::string height = std::to_string(k);
  for (const auto& [tag, text] : {std::pair{DCM_SOPClassUID, std::string(UID_CTImageStorage)},
                                  {DCM_SOPInstanceUID, "1.2.3.7." + height},
                                  {DCM_SeriesInstanceUID, "1.2.3"},
                                  {DCM_Modality, "CT"},
                                  {DCM_ImagePositionPatient, "1\\2\\" + height},
                                  {DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0"},
                                  {DCM_PixelSpacing, "0.25\\0.5"},
                                  {DCM_RescaleIntercept, "-100"},
                                  {DCM_RescaleSlope, "2"},
                                  {DCM_PhotometricInterpretation, "MONOCHROME2"}})
    data.putAndInsertString(tag, text.c_str());
  for (const auto& [tag, value] : {std::pair{DCM_Columns, kColumns},
                                   {DCM_Rows, kRows},
                                   {DCM_SamplesPerPixel, 1},
                                   {DCM_BitsAllocated, 16},
                                   {DCM_BitsStored, 12},
                                   {DCM_HighBit, 11},
                                   {DCM_PixelRepresentation, 0}})
    data.putAndInsertUint16(tag, static_cast<Uint16>(value));
  const std::vector<Uint16> pixels = pixels_of(k);
  data.putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
  return file;
}

void save(DcmFileFormat& file, const fs::path& path, E_TransferSyntax syntax) {
  file.getDataset()->chooseRepresentation(syntax, nullptr);
  file.saveFile(path.c_str(), syntax);
}

// The bytes are a file; beside it lies a sound slice of its series.
void read_file(Bytes bytes, const fs::path& folder) {
  if (!fs::exists(folder / "sound")) save(*slice(1), folder / "sound", EXS_LittleEndianExplicit);
  write_bytes(folder / "file", bytes);
  read_scan(folder, kSmall);
}

void read_directory(Bytes bytes, const fs::path& folder) {
  for (int k = 0; k < 2 && !fs::exists(folder / "I1"); ++k)
    save(*slice(k), folder / ("I" + std::to_string(k)), EXS_LittleEndianExplicit);
  write_bytes(folder / "DICOMDIR", bytes);
  read_scan(folder / "DICOMDIR", kSmall);
}

std::vector<std::string> file_seeds(const fs::path& folder) {
  std::vector<std::string> seeds;
  for (const auto syntax : {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit, EXS_BigEndianExplicit,
                            EXS_DeflatedLittleEndianExplicit, EXS_RLELossless}) {
    save(*slice(0), folder / "a", syntax);
    seeds.push_back(read_bytes(folder / "a"));
  }
  const auto frames = slice(0);
  DcmDataset& data = *frames->getDataset();
  std::vector<Uint16> pixels = pixels_of(0);
  pixels.insert(pixels.end(), pixels.begin(), pixels.end());
  data.putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
  data.putAndInsertString(DCM_NumberOfFrames, "2");
  for (int frame = 0; frame < 2; ++frame) {
    DcmItem* outer = nullptr;
    DcmItem* inner = nullptr;
    data.findOrCreateSequenceItem(DCM_PerFrameFunctionalGroupsSequence, outer, frame);
    outer->findOrCreateSequenceItem(DCM_PlanePositionSequence, inner);
    inner->putAndInsertString(DCM_ImagePositionPatient, frame == 0 ? "1\\2\\3" : "1\\2\\4");
    outer->findOrCreateSequenceItem(DCM_PixelValueTransformationSequence, inner);
    inner->putAndInsertString(DCM_RescaleSlope, "3");
  }
  save(*frames, folder / "a", EXS_LittleEndianExplicit);
  seeds.push_back(read_bytes(folder / "a"));
  return seeds;
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

DcmPixelSequence* fragments(DcmDataset& data, E_TransferSyntax syntax) {
  DcmElement* element = nullptr;
  DcmPixelSequence* sequence = nullptr;
  data.findAndGetElement(DCM_PixelData, element);
  dynamic_cast<DcmPixelData*>(element)->getEncapsulatedRepresentation(syntax, nullptr, sequence);
  return sequence;
}

// The bytes are the compressed pixels of a slice, whose series is sound otherwise.
auto read_pixels_of(E_TransferSyntax syntax) {
  return [syntax](Bytes bytes, const fs::path& folder) {
    if (!fs::exists(folder / "sound")) save(*slice(1), folder / "sound", EXS_LittleEndianExplicit);
    const auto damaged = slice(0);
    auto* pixels = new DcmPixelData(DCM_PixelData);
    auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
    sequence->insert(new DcmPixelItem(DCM_PixelItemTag));
    auto* item = new DcmPixelItem(DCM_PixelItemTag);
    std::vector<Uint8> even(bytes.begin(), bytes.end());
    if (even.size() % 2 != 0) even.push_back(0);
    item->putUint8Array(even.data(), even.size());
    sequence->insert(item);
    pixels->putOriginalRepresentation(syntax, nullptr, sequence);
    damaged->getDataset()->insert(pixels, OFTrue);
    damaged->saveFile((folder / "damaged").c_str(), syntax);
    read_scan(folder, kSmall);
  };
}

auto pixel_seeds(E_TransferSyntax syntax) {
  return [syntax](const fs::path&) -> std::vector<std::string> {
    const auto file = slice(0);
    file->getDataset()->chooseRepresentation(syntax, nullptr);
    DcmPixelItem* item = nullptr;
    fragments(*file->getDataset(), syntax)->getItem(item, 1);
    Uint8* bytes = nullptr;
    item->getUint8Array(bytes);
    return {std::string(reinterpret_cast<const char*>(bytes), item->getLength())};
  };
}

// DCMTK has no encoder of JPEG 2000.
std::vector<std::string> jpeg2000_seeds(const fs::path& folder) {
  opj_image_cmptparm_t size{};
  size.dx = size.dy = 1;
  size.w = kColumns;
  size.h = kRows;
  size.prec = 12;
  opj_image_t* const image = opj_image_create(1, &size, OPJ_CLRSPC_GRAY);
  image->x1 = kColumns;
  image->y1 = kRows;
  const std::vector<Uint16> pixels = pixels_of(0);
  std::copy(pixels.begin(), pixels.end(), image->comps[0].data);
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.tcp_numlayers = 1;
  parameters.cp_disto_alloc = 1;
  parameters.numresolution = 3;
  opj_codec_t* const codec = opj_create_compress(OPJ_CODEC_J2K);
  opj_setup_encoder(codec, &parameters, image);
  opj_stream_t* const stream = opj_stream_create_default_file_stream((folder / "a").c_str(), OPJ_FALSE);
  opj_start_compress(codec, image, stream);
  opj_encode(codec, stream);
  opj_end_compress(codec, stream);
  opj_stream_destroy(stream);
  opj_destroy_codec(codec);
  opj_image_destroy(image);
  return {read_bytes(folder / "a")};
}

}  // namespace

std::vector<Target> dicom_targets() {
  return {{"dicom", read_file, file_seeds},
          {"dicomdir", read_directory, directory_seeds},
          {"rle", read_pixels_of(EXS_RLELossless), pixel_seeds(EXS_RLELossless)},
          {"jpeg", read_pixels_of(EXS_JPEGProcess14SV1), pixel_seeds(EXS_JPEGProcess14SV1)},
          {"jpegls", read_pixels_of(EXS_JPEGLSLossless), pixel_seeds(EXS_JPEGLSLossless)},
          {"jpeg2000", read_pixels_of(EXS_JPEG2000LosslessOnly), jpeg2000_seeds}};
}

}  // namespace osteomill::fuzzing
