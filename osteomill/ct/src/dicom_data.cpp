#include "dicom_data.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcistrmf.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/appender.h>
#include <dcmtk/oflog/oflog.h>
#include <dcmtk/oflog/spi/logevent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "byte_source.h"
#include "utf8_text.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// A level of nesting takes one item, which has at least 16 bytes in the file, and 1.5 KB of stack (measured).
// An Enhanced CT has about ten items per frame.
constexpr std::uint64_t kMaxItems = 1 << 17;
constexpr std::uint64_t kMinItemBytes = 16;
constexpr std::size_t kStackBytes = kMaxItems * 4096;
// Images compress to about a tenth; a file that would inflate by more than this is damaged or malicious.
constexpr std::uint64_t kMaxInflation = 100;
// Longer values stay in the file; no value used here is longer.
constexpr Uint32 kMaxValueBytes = 1024;
// Maximum size of a file without its pixels, bytes.
constexpr std::uint64_t kMaxHeadBytes = 1 << 26;

thread_local bool jpeg_error_found = false;

class JpegErrorAppender : public dcmtk::log4cplus::Appender {
 public:
  ~JpegErrorAppender() override { destructorImpl(); }
  void close() override { closed = true; }

 protected:
  void append(const dcmtk::log4cplus::spi::InternalLoggingEvent& event) override {
    const std::string text = event.getMessage().c_str();
    if (text.find("Corrupt JPEG data") != std::string::npos ||
        text.find("Premature end") != std::string::npos)
      jpeg_error_found = true;
  }
};

// Keeps DCMTK's log off standard error and intercepts the warnings of its JPEG decoders.
void set_up_dcmtk() {
  static const bool once = [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    OFLogger jpeg = OFLog::getLogger("dcmtk.dcmjpeg");
    jpeg.setLogLevel(OFLogger::WARN_LOG_LEVEL);
    jpeg.setAdditivity(false);
    jpeg.addAppender(dcmtk::log4cplus::SharedAppenderPtr(new JpegErrorAppender));
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
    // Files may state one uncompressed syntax and use another.
    dcmAutoDetectDatasetXfer.set(OFTrue);
    // Converts elements of unknown type (UN) that are in the dictionary.
    dcmEnableUnknownVRConversion.set(OFTrue);
    return true;
  }();
  static_cast<void>(once);
}

// After a preamble and "DICM" comes an element. Old files have neither and start with an element of group 2
// or 8.
bool looks_like_dicom(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), "cannot be read");
  std::string head(140, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.size() == 140 && head.compare(128, 4, "DICM") == 0)
    return head.compare(132, 8, std::string(8, '\0')) != 0;
  return head.size() >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0;
}

bool are_zeros(const std::vector<char>& block) {
  return block.front() == 0 && std::memcmp(block.data(), block.data() + 1, block.size() - 1) == 0;
}

// Upper bound on the number of items, each of which starts with its tag in either byte order. Reads the whole
// source.
std::uint64_t count_items(ByteSource& source, std::uint64_t& bytes, std::uint64_t max_bytes) {
  std::uint64_t items = 0;
  std::uint32_t last_four = 0;
  std::vector<char> block(1 << 18);
  for (std::size_t count = block.size(); count == block.size() && bytes <= max_bytes; bytes += count) {
    count = source.read(block);
    WorkProgress::done(0);
    // Sparse files may have gigabytes of zeros.
    if (are_zeros(block)) {
      last_four = 0;
      continue;
    }
    for (std::size_t n = 0; n < count; ++n) {
      last_four = last_four << 8 | static_cast<unsigned char>(block[n]);
      items += last_four == 0xFEFF00E0 || last_four == 0xFFFEE000;
    }
  }
  return items;
}

// Meta group of a file, before its data set.
struct MetaGroup {
  // UID; empty if the file has none.
  std::string syntax;
  std::streamoff end = 0;
};

MetaGroup read_meta_group(const fs::path& path) {
  DcmInputFileStream stream(path.c_str());
  DcmMetaInfo meta;
  meta.transferInit();
  const bool read = meta.read(stream, EXS_Unknown, EGL_noChange, kMaxValueBytes).good();
  meta.transferEnd();
  OFString syntax;
  if (read) meta.findAndGetOFString(DCM_TransferSyntaxUID, syntax);
  return {syntax.c_str(), static_cast<std::streamoff>(stream.tell())};
}

// Syntaxes newer than DCMTK 3.6.7. HTJ2K, with an empty name here, is read as JPEG 2000, of which it is a
// part.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kLaterSyntaxes{
    {{"1.2.840.10008.1.2.4.110", "JPEG XL lossless"},
     {"1.2.840.10008.1.2.4.111", "JPEG XL of a JPEG"},
     {"1.2.840.10008.1.2.4.112", "JPEG XL"},
     {"1.2.840.10008.1.2.4.201", ""},
     {"1.2.840.10008.1.2.4.202", ""},
     {"1.2.840.10008.1.2.4.203", ""},
     {"1.2.840.10008.1.2.4.204", "JPIP HTJ2K"},
     {"1.2.840.10008.1.2.4.205", "JPIP HTJ2K deflated"},
     {"1.2.840.10008.1.2.8.1", "deflated frames"},
     {"1.2.840.113619.5.2", "a private syntax of GE"}}};

bool is_htj2k(std::string_view uid) {
  return std::find(kLaterSyntaxes.begin(), kLaterSyntaxes.end(), std::pair(uid, std::string_view())) !=
         kLaterSyntaxes.end();
}

// Returns whether a decoder supports the syntax.
bool is_decoded(E_TransferSyntax syntax) {
  static constexpr std::array kDecoded{EXS_LittleEndianImplicit,
                                       EXS_LittleEndianExplicit,
                                       EXS_BigEndianExplicit,
                                       EXS_DeflatedLittleEndianExplicit,
                                       EXS_RLELossless,
                                       EXS_JPEGProcess1,
                                       EXS_JPEGProcess2_4,
                                       EXS_JPEGProcess6_8,
                                       EXS_JPEGProcess10_12,
                                       EXS_JPEGProcess14,
                                       EXS_JPEGProcess14SV1,
                                       EXS_JPEGLSLossless,
                                       EXS_JPEGLSLossy,
                                       EXS_JPEG2000LosslessOnly,
                                       EXS_JPEG2000};
  return std::find(kDecoded.begin(), kDecoded.end(), syntax) != kDecoded.end();
}

// Returns name and UID of a syntax without a decoder; empty if it has one or `uid` is empty.
std::string undecodable(const std::string& uid) {
  const DcmXfer syntax(uid.c_str());
  if (uid.empty() || is_htj2k(uid) || is_decoded(syntax.getXfer())) return {};
  std::string name = syntax.getXfer() == EXS_Unknown ? "an unknown transfer syntax" : syntax.getXferName();
  for (const auto& [later, its_name] : kLaterSyntaxes) {
    if (uid == later) name = its_name;
  }
  return fmt::format("{} ({})", name, without_controls(is_utf8(uid) ? uid : utf8_of_latin1(uid), '?'));
}

// Returns whether a file ends in at least 64 KiB of zeros, which would take long to parse.
bool ends_in_zeros(const fs::path& path) {
  std::vector<char> end(1 << 16);
  std::ifstream in(path, std::ios::binary);
  in.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  return in.read(end.data(), static_cast<std::streamsize>(end.size())) && are_zeros(end);
}

// Returns the element with the pixels of a file: a float element if its tag occurs in the head of the file.
// DCMTK could find it only by `readUntilTag`, which crashes on some damaged files. A wrong guess only makes
// DCMTK read further than necessary.
DcmTagKey pixel_element(const fs::path& path) {
  constexpr std::size_t kHead = 1 << 19;
  std::string head(kHead, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  for (const DcmTagKey& floats : {DCM_FloatPixelData, DCM_DoubleFloatPixelData}) {
    const auto element = static_cast<char>(floats.getElement());
    if (head.find({'\xE0', '\x7F', element, '\0'}) != std::string::npos ||
        head.find({'\x7F', '\xE0', '\0', element}) != std::string::npos)
      return floats;
  }
  return DCM_PixelData;
}

// Reads the file up to the element `last`; returns false if it is damaged. `syntax` is the UID of the
// transfer syntax to use; if empty, the one the file states.
bool parse(const fs::path& path, const std::string& syntax, const DcmTagKey& last, DcmFileFormat& file) {
  dcmStopParsingAfterElement.set(last);
  if (syntax.empty()) return file.loadFile(path.c_str(), EXS_Unknown, EGL_noChange, kMaxValueBytes).good();
  file.clear();
  DcmInputFileStream stream(path.c_str());
  file.transferInit();
  file.getMetaInfo()->read(stream, EXS_Unknown, EGL_noChange, kMaxValueBytes);
  file.getMetaInfo()->putAndInsertString(DCM_TransferSyntaxUID, syntax.c_str());
  const bool read = file.read(stream, EXS_Unknown, EGL_noChange, kMaxValueBytes).good();
  file.transferEnd();
  return read;
}

// Returns whether a file with compressed pixels has implicit value representations, which the standard does
// not allow.
bool is_compressed_and_implicit(const fs::path& path, const MetaGroup& meta) {
  if (!is_htj2k(meta.syntax) && !DcmXfer(meta.syntax.c_str()).isEncapsulated()) return false;
  std::ifstream in(path, std::ios::binary);
  in.seekg(meta.end);
  std::array<char, 6> first{};
  in.read(first.data(), static_cast<std::streamsize>(first.size()));
  const auto is_letter = [](char c) { return c >= 'A' && c <= 'Z'; };
  return in && !is_letter(first[4]) && !is_letter(first[5]);
}

// Sets `data.file` and `data.syntax`; returns false if the file is damaged.
bool load(const fs::path& path, const MetaGroup& meta, DicomData& data) {
  // The element after which DCMTK stops is a global variable.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const bool is_implicit = is_compressed_and_implicit(path, meta);
  const std::string of_pixels = is_htj2k(meta.syntax) ? UID_JPEG2000TransferSyntax : meta.syntax;
  const std::string syntax = is_implicit             ? UID_LittleEndianImplicitTransferSyntax
                             : is_htj2k(meta.syntax) ? of_pixels
                                                     : "";
  // Float pixels precede integer ones, so stopping at PixelData would make DCMTK parse the data after them as
  // elements.
  const bool read = (!ends_in_zeros(path) && parse(path, syntax, DCM_PixelData, *data.file)) ||
                    parse(path, syntax, pixel_element(path), *data.file);
  data.syntax = is_implicit ? of_pixels : DcmXfer(data.file->getDataset()->getOriginalXfer()).getXferID();
  return read;
}

// Returns the offset of the hole at the end of a sparse file, from which on there are only zeros.
std::uint64_t end_of_data(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  off_t end = 0;
  for (off_t data = 0; file >= 0 && (data = ::lseek(file, end, SEEK_DATA)) >= 0;)
    end = ::lseek(file, data, SEEK_HOLE);
  if (file >= 0) ::close(file);
  return static_cast<std::uint64_t>(end);
}

void check_bounds(const fs::path& path, const MetaGroup& meta) {
  const std::string subject = path.string();
  std::ifstream in = open_regular_file(subject, path);
  // A deflated data set starts after the meta group.
  std::optional<std::streamoff> deflated;
  if (meta.syntax == UID_DeflatedExplicitVRLittleEndianTransferSyntax) deflated = meta.end;
  if (!deflated && fs::file_size(path) / kMinItemBytes <= kMaxItems) return;
  in.seekg(deflated.value_or(0));
  ByteSource source(std::move(in), deflated ? Packing::deflate : Packing::none);
  const std::uint64_t max_bytes = deflated ? kMaxInflation * source.bytes_in_file() : end_of_data(path);
  std::uint64_t bytes = 0;
  const std::uint64_t items = count_items(source, bytes, max_bytes);
  if (deflated && (!source.has_ended_intact() || bytes > max_bytes)) {
    throw InputError(subject, "is cut short or damaged: its deflated data do not inflate");
  }
  if (items > kMaxItems) throw InputError(subject, "is damaged: it has more sequence items than any scan");
}

}  // namespace

bool take_jpeg_error() {
  return std::exchange(jpeg_error_found, false);
}

std::optional<DicomData> load_dicom(const fs::path& path, std::uint64_t max_bytes) {
  set_up_dcmtk();
  if (!looks_like_dicom(path)) return std::nullopt;
  if (const std::uintmax_t bytes = fs::file_size(path); bytes > max_bytes + kMaxHeadBytes) {
    throw InputError(
        path.string(),
        fmt::format("is {:.3g} GB long, over the limit of {:.3g} GB for its voxels (--max-memory)",
                    static_cast<double>(bytes) * 1e-9, static_cast<double>(max_bytes) * 1e-9));
  }
  const MetaGroup meta = read_meta_group(path);
  check_bounds(path, meta);
  DicomData data{std::make_shared<DcmFileFormat>()};
  data.damaged = !load(path, meta, data);
  data.undecodable = undecodable(meta.syntax);
  return data;
}

void with_dicom_stack(const std::function<void()>& work) {
  struct Job {
    const std::function<void()>& work;
    const WorkProgress::Listener progress;
    std::exception_ptr thrown = nullptr;
  } job{work, WorkProgress::of_this_thread()};
  const auto run = [](void* argument) -> void* {
    auto& mine = *static_cast<Job*>(argument);
    try {
      const WorkProgress here(mine.progress);
      mine.work();
    } catch (...) {
      mine.thrown = std::current_exception();
    }
    return nullptr;
  };
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_t thread{};
  const int failed = ::pthread_create(&thread, &attributes, run, &job);
  ::pthread_attr_destroy(&attributes);
  if (failed != 0) throw std::system_error(failed, std::generic_category());
  ::pthread_join(thread, nullptr);
  if (job.thrown) std::rethrow_exception(job.thrown);
}

}  // namespace osteomill
