#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <openjpeg.h>

/// DICOM files made by tests and fuzzing, in every encoding for which an encoder is available.
namespace osteomill::testing_support {

inline constexpr int kColumns = 7;
inline constexpr int kRows = 5;

/// One slice of a synthetic series with pixels of 0.5 x 0.25 mm, 0.75 mm above the previous one.
struct Slice {
  std::string file = {};
  int k = 0;
  std::string series = "1.2.3";
  std::string instance = {};
  std::string position = {};
  std::string slope = "2";
  std::string image_type = "ORIGINAL\\PRIMARY\\AXIAL";
  E_TransferSyntax syntax = EXS_LittleEndianExplicit;
  std::string modality = "CT";
  /// Bits stored, of 8 or 16 allocated.
  int bits = 12;
};

inline int stored_value(int i, int j, int k) {
  return i + 10 * j + 100 * k;
}

/// Returns the stored values of slice k, row by row.
inline std::vector<int> stored_values(int k) {
  std::vector<int> values;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) values.push_back(stored_value(i, j, k));
  }
  return values;
}

inline void register_encoders() {
  static const bool once = [] {
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    DJLSEncoderRegistration::registerCodecs();
    return true;
  }();
  static_cast<void>(once);
}

inline void put_pixels(DcmDataset& data, const std::vector<int>& values, int bits) {
  if (bits > 8) {
    const std::vector<Uint16> words(values.begin(), values.end());
    data.putAndInsertUint16Array(DCM_PixelData, words.data(), words.size());
  } else {
    std::vector<Uint8> bytes(values.begin(), values.end());
    if (bytes.size() % 2 != 0) bytes.push_back(0);
    data.putAndInsertUint8Array(DCM_PixelData, bytes.data(), bytes.size());
  }
}

inline std::unique_ptr<DcmFileFormat> made_up_slice(const Slice& slice) {
  auto file = std::make_unique<DcmFileFormat>();
  DcmDataset& data = *file->getDataset();
  const std::string number = std::to_string(slice.k + 1);
  const std::string height = std::to_string(10 + 0.75 * slice.k);
  for (const auto& [tag, text] :
       {std::pair{DCM_SOPClassUID, std::string(UID_CTImageStorage)},
        {DCM_SOPInstanceUID, slice.instance.empty() ? slice.series + ".7." + number : slice.instance},
        {DCM_SeriesInstanceUID, slice.series},
        {DCM_Modality, slice.modality},
        {DCM_SeriesDescription, "made up"},
        // A fictitious name, which no message about the series may contain.
        {DCM_PatientName, "Doe^Jane"},
        {DCM_ImageType, slice.image_type},
        {DCM_ImagePositionPatient, slice.position.empty() ? "1\\2\\" + height : slice.position},
        {DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0"},
        {DCM_PixelSpacing, "0.25\\0.5"},
        {DCM_RescaleIntercept, "-100"},
        {DCM_RescaleSlope, slice.slope},
        {DCM_PhotometricInterpretation, "MONOCHROME2"}})
    data.putAndInsertString(tag, text.c_str());
  for (const auto& [tag, value] : {std::pair{DCM_Columns, kColumns},
                                   {DCM_Rows, kRows},
                                   {DCM_SamplesPerPixel, 1},
                                   {DCM_BitsAllocated, slice.bits > 8 ? 16 : 8},
                                   {DCM_BitsStored, slice.bits},
                                   {DCM_HighBit, slice.bits - 1},
                                   {DCM_PixelRepresentation, 0}})
    data.putAndInsertUint16(tag, static_cast<Uint16>(value));
  put_pixels(data, stored_values(slice.k), slice.bits);
  return file;
}

/// Returns slice k with these pixels, as 32-bit or 64-bit floats.
inline std::unique_ptr<DcmFileFormat> made_up_float_slice(int k, const std::vector<Float64>& values,
                                                          bool is_double) {
  auto slice = made_up_slice({.k = k});
  DcmDataset& data = *slice->getDataset();
  for (const DcmTagKey& tag : {DCM_PixelData, DCM_BitsStored, DCM_HighBit, DCM_PixelRepresentation})
    data.findAndDeleteElement(tag);
  data.putAndInsertUint16(DCM_BitsAllocated, is_double ? 64 : 32);
  const std::vector<Float32> floats(values.begin(), values.end());
  if (is_double)
    data.putAndInsertFloat64Array(DCM_DoubleFloatPixelData, values.data(), values.size());
  else
    data.putAndInsertFloat32Array(DCM_FloatPixelData, floats.data(), floats.size());
  return slice;
}

/// Returns the segment at a voxel of the synthetic segmentation, or 0. The last but one slice has no
/// segments.
inline int segment_at(int i, int j, int k) {
  if (k == 2) return 0;
  return i >= 3 && j > k ? 2 : i > 1 ? 1 : 0;
}

/// Returns two overlapping segments on the grid of the first four synthetic slices. `second_height`: z of the
/// second frame, mm.
inline std::unique_ptr<DcmFileFormat> made_up_segmentation(const std::string& second_height = "10.75") {
  auto file = made_up_slice({.series = "1.2.8", .modality = "SEG"});
  DcmDataset& data = *file->getDataset();
  for (const DcmTagKey& tag :
       {DCM_RescaleSlope, DCM_RescaleIntercept, DCM_ImagePositionPatient, DCM_PixelData})
    data.findAndDeleteElement(tag);
  data.putAndInsertString(DCM_SOPClassUID, UID_SegmentationStorage);
  data.putAndInsertString(DCM_SegmentationType, "BINARY");
  data.putAndInsertString(DCM_SpecificCharacterSet, "ISO_IR 100");
  data.putAndInsertString(DCM_NumberOfFrames, "6");
  for (const DcmTagKey& tag : {DCM_BitsAllocated, DCM_BitsStored}) data.putAndInsertUint16(tag, 1);
  data.putAndInsertUint16(DCM_HighBit, 0);
  const auto item_of = [](DcmItem& in, const DcmTagKey& tag, int number = 0) -> DcmItem& {
    DcmItem* item = nullptr;
    in.findOrCreateSequenceItem(tag, item, number);
    return *item;
  };
  DcmItem& measures = item_of(item_of(data, DCM_SharedFunctionalGroupsSequence), DCM_PixelMeasuresSequence);
  measures.putAndInsertString(DCM_PixelSpacing, "0.25\\0.5");
  measures.putAndInsertString(DCM_SpacingBetweenSlices, "0.75");
  const std::array<const char*, 2> names{"mandible",
                                         "Sch\xE4"
                                         "del"};
  for (int segment = 1; segment <= 2; ++segment) {
    DcmItem& item = item_of(data, DCM_SegmentSequence, segment - 1);
    item.putAndInsertUint16(DCM_SegmentNumber, static_cast<Uint16>(segment));
    item.putAndInsertString(DCM_SegmentLabel, names[static_cast<std::size_t>(segment) - 1]);
    const std::array<Uint16, 3> white{65535, 32896, 32896};
    item.putAndInsertUint16Array(DCM_RecommendedDisplayCIELabValue, white.data(), white.size());
  }
  std::vector<Uint8> bits((6 * kRows * kColumns + 7) / 8 + 1);
  std::size_t bit = 0;
  int frame = 0;
  for (const int k : {3, 0, 1}) {
    for (int segment = 1; segment <= 2; ++segment, ++frame) {
      DcmItem& groups = item_of(data, DCM_PerFrameFunctionalGroupsSequence, frame);
      const std::string height =
          frame == 1 && second_height != "10.75" ? second_height : std::to_string(10 + 0.75 * k);
      item_of(groups, DCM_PlanePositionSequence)
          .putAndInsertString(DCM_ImagePositionPatient, ("1\\2\\" + height).c_str());
      item_of(groups, DCM_SegmentIdentificationSequence)
          .putAndInsertUint16(DCM_ReferencedSegmentNumber, static_cast<Uint16>(segment));
      for (int j = 0; j < kRows; ++j) {
        for (int i = 0; i < kColumns; ++i, ++bit) {
          const int found = segment_at(i, j, k);
          if (found == segment || (segment == 1 && found == 2 && i == 3))
            bits[bit / 8] = static_cast<Uint8>(bits[bit / 8] | 1U << bit % 8);
        }
      }
    }
  }
  if (bits.size() % 2 != 0) bits.push_back(0);
  data.putAndInsertUint8Array(DCM_PixelData, bits.data(), bits.size());
  return file;
}

/// Returns false if encoding or writing fails.
inline bool save(DcmFileFormat& file, const std::filesystem::path& path, E_TransferSyntax syntax) {
  register_encoders();
  return file.getDataset()->chooseRepresentation(syntax, nullptr).good() &&
         file.saveFile(path.c_str(), syntax).good();
}

/// Returns the compressed pixels; the first item is the offset table.
inline DcmPixelSequence* fragments(DcmDataset& data, E_TransferSyntax syntax) {
  DcmElement* element = nullptr;
  DcmPixelSequence* sequence = nullptr;
  data.findAndGetElement(DCM_PixelData, element);
  dynamic_cast<DcmPixelData*>(element)->getEncapsulatedRepresentation(syntax, nullptr, sequence);
  return sequence;
}

/// Replaces the pixels of a one-frame image by a compressed stream.
inline void put_fragment(DcmDataset& data, E_TransferSyntax syntax, std::span<const unsigned char> stream) {
  auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
  sequence->insert(new DcmPixelItem(DCM_PixelItemTag));
  auto* item = new DcmPixelItem(DCM_PixelItemTag);
  std::vector<Uint8> even(stream.begin(), stream.end());
  if (even.size() % 2 != 0) even.push_back(0);
  item->putUint8Array(even.data(), even.size());
  sequence->insert(item);
  auto* pixels = new DcmPixelData(DCM_PixelData);
  pixels->putOriginalRepresentation(syntax, nullptr, sequence);
  data.insert(pixels, OFTrue);
}

inline std::vector<unsigned char> bytes_of(DcmPixelItem& fragment) {
  Uint8* bytes = nullptr;
  fragment.getUint8Array(bytes);
  return {bytes, bytes + fragment.getLength()};
}

/// Returns a JPEG 2000 code stream of one grey frame, made by OpenJPEG because DCMTK has no encoder. `ratio`:
/// compression ratio; 0: lossless.
inline std::vector<unsigned char> jpeg2000_stream(std::span<const int> values, int columns, int rows,
                                                  int bits, bool is_signed, float ratio = 0) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = static_cast<OPJ_UINT32>(columns);
  component.h = static_cast<OPJ_UINT32>(rows);
  component.prec = static_cast<OPJ_UINT32>(bits);
  component.sgnd = is_signed ? 1 : 0;
  opj_image_t* const image = opj_image_create(1, &component, OPJ_CLRSPC_GRAY);
  image->x1 = component.w;
  image->y1 = component.h;
  std::copy(values.begin(), values.end(), image->comps[0].data);
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.numresolution = 2;
  parameters.tcp_numlayers = 1;
  parameters.tcp_rates[0] = ratio;
  parameters.irreversible = ratio > 0 ? 1 : 0;
  parameters.cp_disto_alloc = 1;
  opj_codec_t* const codec = opj_create_compress(OPJ_CODEC_J2K);
  std::vector<unsigned char> bytes;
  opj_stream_t* const stream = opj_stream_default_create(OPJ_FALSE);
  opj_stream_set_user_data(stream, &bytes, nullptr);
  opj_stream_set_write_function(stream, [](void* from, OPJ_SIZE_T count, void* user) {
    auto* first = static_cast<unsigned char*>(from);
    auto& kept = *static_cast<std::vector<unsigned char>*>(user);
    kept.insert(kept.end(), first, first + count);
    return count;
  });
  const bool made = opj_setup_encoder(codec, &parameters, image) &&
                    opj_start_compress(codec, image, stream) && opj_encode(codec, stream) &&
                    opj_end_compress(codec, stream);
  opj_stream_destroy(stream);
  opj_destroy_codec(codec);
  opj_image_destroy(image);
  if (!made) bytes.clear();
  return bytes;
}

}  // namespace osteomill::testing_support
