#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcfcache.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "dicom_data.h"
#include "dicom_file.h"
#include "frame_decoders.h"

namespace osteomill {

namespace {

template <typename Stored>
void rescale(std::span<const char> values, const StoredPixels& pixels, float* densities) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const char* bytes = values.data();
  for (std::size_t n = 0; n < values.size() / sizeof(Stored); ++n, bytes += sizeof(Stored)) {
    Stored raw = 0;
    std::memcpy(&raw, bytes, sizeof(raw));
    double value = 0;
    bool is_padding = false;
    if constexpr (std::is_floating_point_v<Stored>) {
      value = static_cast<double>(raw);
    } else {
      value = value_of(raw, pixels);
      is_padding = pixels.padding && pixels.padding->word == std::uint32_t{raw};
    }
    is_padding = is_padding || (pixels.padding && pixels.padding->holds(value));
    densities[n] = is_padding ? kNone : static_cast<float>(pixels.slope * value + pixels.intercept);
  }
}

void rescale_frame(std::span<const char> values, const StoredPixels& pixels, float* densities) {
  if (pixels.is_float) {
    return pixels.bits_allocated == 64 ? rescale<double>(values, pixels, densities)
                                       : rescale<float>(values, pixels, densities);
  }
  switch (pixels.bits_allocated) {
    case 1:
    case 8:
      return rescale<std::uint8_t>(values, pixels, densities);
    case 16:
      return rescale<std::uint16_t>(values, pixels, densities);
    default:
      return rescale<std::uint32_t>(values, pixels, densities);
  }
}

// Decodes the frames of one file one after the other.
class FrameReader {
 public:
  explicit FrameReader(const DicomHeader& header);

  // Returns the decoded frame, valid until the next call.
  std::span<const char> read(std::size_t frame);
  // Returns the format of the values read last: the header's, unless the compressed data are signed and the
  // header is not.
  StoredPixels form(std::size_t frame);
  // Returns whether that changed any value.
  bool has_sign_mismatch() const { return has_sign_mismatch_; }

 private:
  InputError fault(const std::string& reason) const { return {header_.file.string(), reason}; }
  InputError damaged() const {
    return fault(fmt::format("cannot be decoded ({}): its pixels are cut short or damaged",
                             DcmXfer(syntax_).getXferName()));
  }
  std::span<const unsigned char> bytes_of(DcmPixelItem* item) const;
  std::size_t first_fragment(std::size_t frame) const;
  std::vector<unsigned char> stream_of(std::size_t frame) const;
  void decode_jpeg(std::span<const unsigned char> stream);
  void read_uncompressed(std::size_t frame);
  void read_floats(std::size_t frame);
  void read_bits(std::size_t frame);
  void read_by_dcmtk(DcmDataset& data, std::size_t frame, DcmFileCache* cache);

  const DicomHeader& header_;
  DcmDataset& data_;
  E_TransferSyntax syntax_;
  FrameSize size_;
  std::vector<DcmPixelItem*> items_;
  DcmFileCache cache_;
  // Size is even, as DCMTK requires.
  std::vector<char> values_;
  bool stream_is_signed_ = false;
  bool has_sign_mismatch_ = false;
};

FrameReader::FrameReader(const DicomHeader& header)
    : header_(header),
      data_(*header.data->getDataset()),
      syntax_(DcmXfer(header.syntax.c_str()).getXfer()),
      size_{header.columns, header.rows, std::max(1, header.slices.front().pixels.bits_allocated / 8)},
      items_(pixel_items_of(data_)),
      values_(size_.bytes() + size_.bytes() % 2) {}

std::span<const unsigned char> FrameReader::bytes_of(DcmPixelItem* item) const {
  Uint8* bytes = nullptr;
  if (item->getUint8Array(bytes).bad() || bytes == nullptr) throw fault("is cut short");
  return {bytes, item->getLength()};
}

// Returns the index of a frame's first item. There is one frame, one fragment per frame, or an offset table
// with the number of bytes before each frame, including 8 per fragment (Part 5, A.4).
std::size_t FrameReader::first_fragment(std::size_t frame) const {
  if (frame == 0 || items_.size() == header_.frames + 1) return frame + 1;
  if (frame == header_.frames) return items_.size();
  const std::size_t offsets = items_.front()->getLength() / sizeof(std::uint32_t);
  if (offsets == header_.frames) {
    std::uint32_t offset = 0;
    std::memcpy(&offset, bytes_of(items_.front()).data() + frame * sizeof(offset), sizeof(offset));
    std::uint64_t before = 0;
    for (std::size_t n = 1; n < items_.size(); before += 8 + items_[n++]->getLength()) {
      if (before == offset) return n;
    }
  }
  throw fault("does not state which of its fragments belong to which frame");
}

std::vector<unsigned char> FrameReader::stream_of(std::size_t frame) const {
  std::vector<unsigned char> stream;
  const std::size_t end = first_fragment(frame + 1);
  for (std::size_t n = first_fragment(frame); n < end; ++n) {
    const std::span<const unsigned char> bytes = bytes_of(items_[n]);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  return stream;
}

void FrameReader::read_by_dcmtk(DcmDataset& data, std::size_t frame, DcmFileCache* cache) {
  OFString colours;
  DcmElement* element = nullptr;
  data.findAndGetElement(DCM_PixelData, element);
  auto* pixels = dynamic_cast<DcmPixelData*>(element);
  if (pixels == nullptr) throw fault("has pixels of a kind that is not supported");
  Uint32 fragment = 0;
  const OFCondition read =
      pixels->getUncompressedFrame(&data, static_cast<Uint32>(frame), fragment, values_.data(),
                                   static_cast<Uint32>(values_.size()), colours, cache);
  const bool is_damaged = take_jpeg_error();
  if (read.bad() || is_damaged) throw damaged();
}

// Decodes in a separate data set that contains nothing else, so that a wrong offset table does no harm.
void FrameReader::decode_jpeg(std::span<const unsigned char> stream) {
  const bool is_jpeg_ls = syntax_ == EXS_JPEGLSLossless || syntax_ == EXS_JPEGLSLossy;
  if (!is_valid_jpeg(stream, is_jpeg_ls ? JpegKind::jpeg_ls : JpegKind::jpeg, size_))
    throw fault("is damaged: its compressed pixels do not match its header");
  DcmDataset alone;
  for (const DcmTagKey& tag : {DCM_SamplesPerPixel, DCM_PhotometricInterpretation, DCM_Rows, DCM_Columns,
                               DCM_BitsAllocated, DCM_BitsStored, DCM_HighBit, DCM_PixelRepresentation}) {
    DcmElement* copy = nullptr;
    if (data_.findAndGetElement(tag, copy, OFFalse, OFTrue).good()) alone.insert(copy);
  }
  auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
  sequence->insert(new DcmPixelItem(DCM_PixelItemTag));
  auto* fragment = new DcmPixelItem(DCM_PixelItemTag);
  fragment->putUint8Array(stream.data(), stream.size());
  sequence->insert(fragment);
  auto* pixels = new DcmPixelData(DCM_PixelData);
  pixels->putOriginalRepresentation(syntax_, nullptr, sequence);
  alone.insert(pixels);
  read_by_dcmtk(alone, 0, nullptr);
}

void FrameReader::read_uncompressed(std::size_t frame) {
  read_by_dcmtk(data_, frame, &cache_);
  // DCMTK swaps only within 16-bit words, so the two words of each value are still in big-endian order.
  if (syntax_ == EXS_BigEndianExplicit && size_.bytes_a_value == 4) {
    for (std::size_t n = 0; n < size_.bytes(); n += 4)
      std::swap_ranges(&values_[n], &values_[n] + 2, &values_[n] + 2);
  }
}

void FrameReader::read_floats(std::size_t frame) {
  const auto copy = [&](const auto* numbers, unsigned long count) {
    const std::size_t first = frame * size_.values();
    if (numbers == nullptr || count < first + size_.values()) throw fault("is cut short");
    std::memcpy(values_.data(), numbers + first, size_.bytes());
  };
  unsigned long count = 0;
  if (size_.bytes_a_value == 4) {
    const Float32* numbers = nullptr;
    if (data_.findAndGetFloat32Array(DCM_FloatPixelData, numbers, &count).bad()) numbers = nullptr;
    copy(numbers, count);
  } else {
    const Float64* numbers = nullptr;
    if (data_.findAndGetFloat64Array(DCM_DoubleFloatPixelData, numbers, &count).bad()) numbers = nullptr;
    copy(numbers, count);
  }
}

// Frames follow each other without padding bits; the first pixel is the lowest bit.
void FrameReader::read_bits(std::size_t frame) {
  const Uint8* bytes = nullptr;
  unsigned long count = 0;
  const std::size_t first = frame * size_.values();
  if (data_.findAndGetUint8Array(DCM_PixelData, bytes, &count).bad() || bytes == nullptr ||
      8 * count < first + size_.values())
    throw fault("is cut short, or has compressed single-bit pixels");
  for (std::size_t n = 0; n < size_.values(); ++n)
    values_[n] = static_cast<char>(bytes[(first + n) / 8] >> (first + n) % 8 & 1);
}

std::span<const char> FrameReader::read(std::size_t frame) {
  const std::span<char> values(values_.data(), size_.bytes());
  if (header_.slices[frame].pixels.is_float) {
    read_floats(frame);
    return values;
  }
  if (header_.slices[frame].pixels.bits_allocated == 1) {
    read_bits(frame);
    return values;
  }
  if (items_.empty()) {
    read_uncompressed(frame);
    return values;
  }
  const std::vector<unsigned char> stream = stream_of(frame);
  switch (syntax_) {
    case EXS_RLELossless:
      if (!decode_rle(stream, size_, values)) throw damaged();
      break;
    case EXS_JPEG2000LosslessOnly:
    case EXS_JPEG2000:
      if (!decode_jpeg2000(stream, size_, values)) throw damaged();
      stream_is_signed_ = is_signed_jpeg2000(stream);
      break;
    default:
      decode_jpeg(stream);
  }
  return values;
}

StoredPixels FrameReader::form(std::size_t frame) {
  StoredPixels pixels = header_.slices[frame].pixels;
  if (!stream_is_signed_ || pixels.is_signed) return pixels;
  // The decoder has sign-extended the values.
  const auto value_bytes = static_cast<std::size_t>(size_.bytes_a_value);
  for (std::size_t n = value_bytes - 1; n < size_.bytes(); n += value_bytes)
    has_sign_mismatch_ = has_sign_mismatch_ || values_[n] < 0;
  pixels.is_signed = true;
  pixels.bits_stored = pixels.bits_allocated;
  return pixels;
}

}  // namespace

bool read_dicom_densities(const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities) {
  FrameReader reader(header);
  for (std::size_t frame = 0; frame < header.slices.size(); ++frame) {
    float* densities = frame_densities(frame);
    if (densities == nullptr) continue;
    const std::span<const char> values = reader.read(frame);
    rescale_frame(values, reader.form(frame), densities);
  }
  return reader.has_sign_mismatch();
}

}  // namespace osteomill
