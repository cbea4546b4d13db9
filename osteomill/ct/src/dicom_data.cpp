#include "dicom_data.h"

#include <cstdint>
#include <exception>
#include <system_error>
#include <utility>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcistrmf.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/appender.h>
#include <dcmtk/oflog/oflog.h>
#include <dcmtk/oflog/spi/logevent.h>
#include <fmt/format.h>
#include <pthread.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "byte_source.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// A level of nesting takes an item, which has 16 bytes at the least in the file, and 1.5 KB of stack (as
// measured). An Enhanced CT has about ten items a frame.
constexpr std::uint64_t kMaxItems = 1 << 17;
constexpr std::uint64_t kMinItemBytes = 16;
constexpr std::size_t kStackBytes = kMaxItems * 4096;
// Images come down to a tenth or so; what would grow more than this is damaged or meant to fill the memory.
constexpr std::uint64_t kMaxInflation = 100;
// Longer values stay in the file. None that is wanted is longer.
constexpr Uint32 kMaxValueBytes = 1024;
// Largest size of a file beside its pixels, bytes.
constexpr std::uint64_t kMaxHeadBytes = 1 << 26;

thread_local bool jpeg_complained = false;

class ComplaintAppender : public dcmtk::log4cplus::Appender {
 public:
  ~ComplaintAppender() override { destructorImpl(); }
  void close() override { closed = true; }

 protected:
  void append(const dcmtk::log4cplus::spi::InternalLoggingEvent& event) override {
    const std::string text = event.getMessage().c_str();
    if (text.find("Corrupt JPEG data") != std::string::npos ||
        text.find("Premature end") != std::string::npos)
      jpeg_complained = true;
  }
};

// Nothing of DCMTK's reaches standard error, and its JPEG decoders' warnings come to us.
void set_up_dcmtk() {
  static const bool once = [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    OFLogger jpeg = OFLog::getLogger("dcmtk.dcmjpeg");
    jpeg.setLogLevel(OFLogger::WARN_LOG_LEVEL);
    jpeg.setAdditivity(false);
    jpeg.addAppender(dcmtk::log4cplus::SharedAppenderPtr(new ComplaintAppender));
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
    // Elements of an unknown kind (UN) that the dictionary knows.
    dcmEnableUnknownVRConversion.set(OFTrue);
    return true;
  }();
  static_cast<void>(once);
}

// Behind a preamble and "DICM" comes an element. Old files have neither, and begin with one of group 2 or 8.
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

// How many items there can be: every one begins with its tag, in either order of bytes. Reads it all.
std::uint64_t count_items(ByteSource& source, std::uint64_t& bytes, std::uint64_t max_bytes) {
  std::uint64_t items = 0;
  std::uint32_t last_four = 0;
  std::vector<char> block(1 << 18);
  for (std::size_t count = block.size(); count == block.size() && bytes <= max_bytes; bytes += count) {
    count = source.read(block);
    for (std::size_t n = 0; n < count; ++n) {
      last_four = last_four << 8 | static_cast<unsigned char>(block[n]);
      items += last_four == 0xFEFF00E0 || last_four == 0xFFFEE000;
    }
  }
  return items;
}

// If the data set is deflated it begins behind the meta group, as DCMTK reads that.
std::optional<std::streamoff> start_of_deflated(const fs::path& path) {
  DcmInputFileStream stream(path.c_str());
  DcmMetaInfo meta;
  meta.transferInit();
  const bool read = meta.read(stream, EXS_Unknown, EGL_noChange, kMaxValueBytes).good();
  meta.transferEnd();
  OFString syntax;
  meta.findAndGetOFString(DCM_TransferSyntaxUID, syntax);
  if (!read || syntax != UID_DeflatedExplicitVRLittleEndianTransferSyntax) return std::nullopt;
  return static_cast<std::streamoff>(stream.tell());
}

void check_bounds(const fs::path& path) {
  const std::string subject = path.string();
  std::ifstream in = open_regular_file(subject, path);
  const std::optional<std::streamoff> deflated = start_of_deflated(path);
  if (!deflated && fs::file_size(path) / kMinItemBytes <= kMaxItems) return;
  in.seekg(deflated.value_or(0));
  ByteSource source(std::move(in), deflated ? Packing::deflate : Packing::none);
  const std::uint64_t max_bytes = deflated ? kMaxInflation * source.bytes_in_file() : source.max_bytes();
  std::uint64_t bytes = 0;
  const std::uint64_t items = count_items(source, bytes, max_bytes);
  if (deflated && (!source.ended_well() || bytes > max_bytes)) {
    throw InputError(subject, "is cut short or damaged: its deflated data do not inflate");
  }
  if (items > kMaxItems) throw InputError(subject, "is damaged: no scan has as many sequence items");
}

}  // namespace

bool take_jpeg_complaint() {
  return std::exchange(jpeg_complained, false);
}

std::optional<DicomData> load_dicom(const fs::path& path, std::uint64_t max_bytes) {
  set_up_dcmtk();
  if (!looks_like_dicom(path)) return std::nullopt;
  if (const std::uintmax_t bytes = fs::file_size(path); bytes > max_bytes + kMaxHeadBytes) {
    throw InputError(path.string(),
                     fmt::format("is {:.3g} GB long, over the {:.3g} GB that its voxels may take",
                                 static_cast<double>(bytes) * 1e-9, static_cast<double>(max_bytes) * 1e-9));
  }
  check_bounds(path);
  DicomData data{std::make_shared<DcmFileFormat>()};
  data.damaged = data.file->loadFile(path.c_str(), EXS_Unknown, EGL_noChange, kMaxValueBytes).bad();
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
