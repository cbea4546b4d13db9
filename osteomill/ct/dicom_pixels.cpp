#include "osteomill/ct/dicom_pixels.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <type_traits>

#include <fmt/format.h>
#include <gdcmException.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmUIDs.h>

#include "osteomill/ct/captured_stderr.h"
#include "osteomill/ct/dicom_elements.h"
#include "osteomill/ct/jpeg_frame.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

struct Fault {
  std::string reason;
};

std::string codec_name(const std::string& transfer_syntax) {
  gdcm::UIDs names;
  const bool known = names.SetFromUID(transfer_syntax.c_str()) && names.GetName() != nullptr;
  return known ? names.GetName() : "transfer syntax " + transfer_syntax;
}

template <typename Stored>
void rescale(const std::vector<char>& buffer, std::size_t first, const StoredPixels& pixels,
             std::size_t count, float* densities) {
  // Bits above the stored ones may hold anything; the sign is in the highest stored one.
  using Wide = std::make_unsigned_t<Stored>;
  const int unused = static_cast<int>(8 * sizeof(Stored)) - pixels.bits_stored;
  const char* bytes = buffer.data() + first * sizeof(Stored);
  for (std::size_t n = 0; n < count; ++n, bytes += sizeof(Stored)) {
    Wide raw = 0;
    std::memcpy(&raw, bytes, sizeof(raw));
    raw = static_cast<Wide>(raw << unused);
    const auto value = static_cast<Stored>(static_cast<Stored>(raw) >> unused);
    densities[n] = static_cast<float>(pixels.slope * static_cast<double>(value) + pixels.intercept);
  }
}

void rescale_frame(const std::vector<char>& buffer, std::size_t first, const StoredPixels& pixels,
                   std::size_t count, float* densities) {
  const int kind = pixels.is_signed ? -pixels.bits_allocated : pixels.bits_allocated;
  switch (kind) {
    case 8:
      return rescale<std::uint8_t>(buffer, first, pixels, count, densities);
    case -8:
      return rescale<std::int8_t>(buffer, first, pixels, count, densities);
    case 16:
      return rescale<std::uint16_t>(buffer, first, pixels, count, densities);
    case -16:
      return rescale<std::int16_t>(buffer, first, pixels, count, densities);
    case 32:
      return rescale<std::uint32_t>(buffer, first, pixels, count, densities);
    default:
      return rescale<std::int32_t>(buffer, first, pixels, count, densities);
  }
}

std::vector<char> read_part(std::istream& in, const DicomPixels::Part& part) {
  std::vector<char> bytes(part.length);
  in.seekg(static_cast<std::streamoff>(part.offset));
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) throw Fault{"is cut short"};
  return bytes;
}

std::vector<char> read_plain(std::istream& in, const DicomFile& file, int bytes_a_value,
                             std::uint64_t needed) {
  std::vector<char> bytes = read_part(in, {file.pixels.parts.front().offset, needed});
  if (file.big_endian == (std::endian::native == std::endian::big)) return bytes;
  const auto step = static_cast<std::ptrdiff_t>(bytes_a_value);
  for (auto value = bytes.begin(); value != bytes.end(); value += step) std::reverse(value, value + step);
  return bytes;
}

// The decoders take the stream's word for its size, and write as much.
void check_frame(std::span<const char> fragment, const DicomHeader& header) {
  const std::optional<JpegFrame> frame = find_jpeg_frame(fragment);
  if (!frame) return;
  const int most_bits = header.slices.front().pixels.bits_allocated;
  if (frame->columns != header.columns || frame->rows != header.rows || frame->components != 1 ||
      !frame->plain || frame->bits > most_bits) {
    throw Fault{
        fmt::format("is damaged: its compressed pixels ({} x {}, {} bits) are not what its header says",
                    frame->columns, frame->rows, frame->bits)};
  }
}

gdcm::DataElement fragments_of(std::istream& in, const DicomFile& file, const DicomHeader& header) {
  const auto sequence = gdcm::SequenceOfFragments::New();
  // The first is the table of offsets, which nobody needs.
  for (std::size_t n = 1; n < file.pixels.parts.size(); ++n) {
    const std::vector<char> bytes = read_part(in, file.pixels.parts[n]);
    check_frame(bytes, header);
    gdcm::Fragment fragment;
    fragment.SetByteValue(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    sequence->AddFragment(fragment);
  }
  gdcm::DataElement element(gdcm::Tag(0x7FE0, 0x0010));
  element.SetVR(gdcm::VR::OB);
  element.SetValue(*sequence);
  return element;
}

std::vector<char> decompress(std::istream& in, const DicomFile& file, const DicomHeader& header,
                             std::uint64_t needed) {
  const StoredPixels& pixels = header.slices.front().pixels;
  const auto bits = static_cast<unsigned short>(pixels.bits_allocated);
  const auto stored = static_cast<unsigned short>(pixels.bits_stored);
  gdcm::Image image;
  image.SetNumberOfDimensions(3);
  image.SetDimension(0, static_cast<unsigned>(header.columns));
  image.SetDimension(1, static_cast<unsigned>(header.rows));
  image.SetDimension(2, static_cast<unsigned>(header.frames));
  image.SetPixelFormat(gdcm::PixelFormat(1, bits, stored, static_cast<unsigned short>(stored - 1),
                                         static_cast<unsigned short>(pixels.is_signed ? 1 : 0)));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  const auto syntax = gdcm::TransferSyntax::GetTSType(header.transfer_syntax.c_str());
  if (syntax == gdcm::TransferSyntax::TS_END) {
    throw Fault{fmt::format("is compressed in a way that is not known ({})", header.transfer_syntax)};
  }
  image.SetTransferSyntax(syntax);
  image.SetDataElement(fragments_of(in, file, header));
  std::vector<char> buffer(needed);
  const CapturedStderr captured;
  const bool done = image.GetBufferLength() == needed && image.GetBuffer(buffer.data()) &&
                    image.GetBufferLength() == needed;
  // libjpeg goes on with what it has.
  if (!done || captured.text().find("Corrupt JPEG data") != std::string::npos) {
    throw Fault{fmt::format("cannot be decompressed ({}): its pixels are cut short or damaged",
                            codec_name(header.transfer_syntax))};
  }
  return buffer;
}

std::vector<char> read_pixels(const DicomHeader& header) {
  const std::optional<DicomFile> file = read_dicom_elements(header.file);
  if (!file || file->fault || file->pixels.parts.empty()) throw Fault{"has changed while it was read"};
  const int value_bytes = header.slices.front().pixels.bits_allocated / 8;
  const std::uint64_t needed = static_cast<std::uint64_t>(header.columns) *
                               static_cast<std::uint64_t>(header.rows) * header.frames *
                               static_cast<std::uint64_t>(value_bytes);
  const std::unique_ptr<std::istream> in = open_dicom_data(header.file);
  if (file->pixels.compressed) return decompress(*in, *file, header, needed);
  if (file->pixels.bytes() < needed) throw Fault{"has changed while it was read"};
  return read_plain(*in, *file, value_bytes, needed);
}

}  // namespace

void read_dicom_densities(const std::string& subject, const DicomHeader& header,
                          const std::function<float*(std::size_t frame)>& frame_densities) {
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::Trace::DebugOff();
  const std::string name = header.file.filename().string();
  try {
    const std::vector<char> buffer = read_pixels(header);
    const std::size_t count =
        static_cast<std::size_t>(header.columns) * static_cast<std::size_t>(header.rows);
    for (const DicomSlice& slice : header.slices) {
      float* densities = frame_densities(slice.frame);
      if (densities != nullptr) rescale_frame(buffer, slice.frame * count, slice.pixels, count, densities);
    }
  } catch (const Fault& fault) {
    throw InputError(subject, name + " " + fault.reason);
  } catch (const gdcm::Exception&) {
    throw InputError(subject,
                     fmt::format("{} cannot be decompressed ({})", name, codec_name(header.transfer_syntax)));
  }
}

}  // namespace osteomill
