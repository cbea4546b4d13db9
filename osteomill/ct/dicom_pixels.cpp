#include "osteomill/ct/dicom_pixels.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcfcache.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include "osteomill/ct/dicom_data.h"
#include "osteomill/ct/dicom_file.h"
#include "osteomill/ct/frame_decoders.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

template <typename Stored>
void rescale(std::span<const char> values, const StoredPixels& pixels, float* densities) {
  // Bits above the stored ones may hold anything; the sign is in the highest stored one.
  using Wide = std::make_unsigned_t<Stored>;
  const int unused = static_cast<int>(8 * sizeof(Stored)) - pixels.bits_stored;
  const char* bytes = values.data();
  for (std::size_t n = 0; n < values.size() / sizeof(Stored); ++n, bytes += sizeof(Stored)) {
    Wide raw = 0;
    std::memcpy(&raw, bytes, sizeof(raw));
    raw = static_cast<Wide>(raw << unused);
    const auto value = static_cast<Stored>(static_cast<Stored>(raw) >> unused);
    densities[n] = static_cast<float>(pixels.slope * static_cast<double>(value) + pixels.intercept);
  }
}

void rescale_frame(std::span<const char> values, const StoredPixels& pixels, float* densities) {
  const int kind = pixels.is_signed ? -pixels.bits_allocated : pixels.bits_allocated;
  switch (kind) {
    case 8:
      return rescale<std::uint8_t>(values, pixels, densities);
    case -8:
      return rescale<std::int8_t>(values, pixels, densities);
    case 16:
      return rescale<std::uint16_t>(values, pixels, densities);
    case -16:
      return rescale<std::int16_t>(values, pixels, densities);
    case 32:
      return rescale<std::uint32_t>(values, pixels, densities);
    default:
      return rescale<std::int32_t>(values, pixels, densities);
  }
}

// The frames of one file, decoded one after the other.
class FrameReader {
 public:
  explicit FrameReader(const DicomHeader& header);

  // Stays until the next one is read.
  std::span<const char> read(std::size_t frame);

 private:
  InputError fault(const std::string& reason) const { return {header_.file.string(), reason}; }
  std::span<const unsigned char> bytes_of(DcmPixelItem* fragment) const;
  std::vector<unsigned char> stream_of(std::size_t frame) const;
  void decode_by_dcmtk(std::size_t frame);

  const DicomHeader& header_;
  DcmDataset& data_;
  E_TransferSyntax syntax_;
  FrameSize size_;
  std::vector<DcmPixelItem*> fragments_;
  DcmFileCache cache_;
  Uint32 next_fragment_ = 0;
  // DCMTK wants an even number of bytes.
  std::vector<char> values_;
};

FrameReader::FrameReader(const DicomHeader& header)
    : header_(header),
      data_(*header.data->getDataset()),
      syntax_(data_.getOriginalXfer()),
      size_{header.columns, header.rows, header.slices.front().pixels.bits_allocated / 8},
      fragments_(fragments_of(data_)),
      values_(size_.bytes() + size_.bytes() % 2) {}

std::span<const unsigned char> FrameReader::bytes_of(DcmPixelItem* fragment) const {
  Uint8* bytes = nullptr;
  if (fragment->getUint8Array(bytes).bad() || bytes == nullptr) throw fault("is cut short");
  return {bytes, fragment->getLength()};
}

// The fragments of a frame: one, or all where there is one frame.
std::vector<unsigned char> FrameReader::stream_of(std::size_t frame) const {
  std::span<DcmPixelItem* const> fragments = fragments_;
  if (header_.frames > 1) {
    if (fragments.size() != header_.frames)
      throw fault("has frames in several fragments each, which is not supported");
    fragments = fragments.subspan(frame, 1);
  }
  std::vector<unsigned char> stream;
  for (DcmPixelItem* fragment : fragments) {
    const std::span<const unsigned char> bytes = bytes_of(fragment);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  return stream;
}

void FrameReader::decode_by_dcmtk(std::size_t frame) {
  OFString colours;
  DcmElement* element = nullptr;
  data_.findAndGetElement(DCM_PixelData, element);
  auto* pixels = dynamic_cast<DcmPixelData*>(element);
  if (pixels == nullptr) throw fault("has pixels of a kind that is not supported");
  const JpegComplaints complaints;
  const OFCondition decoded =
      pixels->getUncompressedFrame(&data_, static_cast<Uint32>(frame), next_fragment_, values_.data(),
                                   static_cast<Uint32>(values_.size()), colours, &cache_);
  if (decoded.bad() || complaints.any()) {
    throw fault(fmt::format("cannot be decoded ({}): its pixels are cut short or damaged",
                            DcmXfer(syntax_).getXferName()));
  }
}

std::span<const char> FrameReader::read(std::size_t frame) {
  const std::span<char> values(values_.data(), size_.bytes());
  const auto check = [&](bool decoded, const char* name) {
    if (!decoded)
      throw fault(fmt::format("cannot be decoded ({}): its pixels are cut short or damaged", name));
  };
  switch (syntax_) {
    case EXS_RLELossless:
      check(decode_rle(stream_of(frame), size_, values), "RLE");
      break;
    case EXS_JPEG2000LosslessOnly:
    case EXS_JPEG2000:
      check(decode_jpeg2000(stream_of(frame), size_, values), "JPEG 2000");
      break;
    default:
      for (DcmPixelItem* fragment : fragments_) {
        if (!jpeg_fits(bytes_of(fragment), size_))
          throw fault("is damaged: its compressed pixels are not what its header says");
      }
      decode_by_dcmtk(frame);
      // To DCMTK pixels are words of 16 bits, of which the higher comes first here.
      if (syntax_ == EXS_BigEndianExplicit && size_.bytes_a_value == 4) {
        for (std::size_t n = 0; n < values.size(); n += 4)
          std::swap_ranges(&values[n], &values[n] + 2, &values[n] + 2);
      }
  }
  return values;
}

}  // namespace

void read_dicom_densities(const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities) {
  FrameReader reader(header);
  for (const DicomSlice& slice : header.slices) {
    float* densities = frame_densities(slice.frame);
    if (densities != nullptr) rescale_frame(reader.read(slice.frame), slice.pixels, densities);
  }
}

}  // namespace osteomill
