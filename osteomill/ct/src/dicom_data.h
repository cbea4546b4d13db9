#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

class DcmFileFormat;

namespace osteomill {

/// DICOM file as read by DCMTK. Long values (the pixels) stay in the file until they are requested.
struct DicomData {
  std::shared_ptr<DcmFileFormat> file;
  /// True if the file is cut short or damaged; the elements before the damage are valid.
  bool damaged = false;
  /// UID of the actual transfer syntax of the pixels, which may differ from the one stated in the file.
  std::string syntax{};
  /// Transfer syntax if no decoder supports it; otherwise empty.
  std::string undecodable{};
};

/// Reads a DICOM file; returns nullopt if it is not DICOM. Throws InputError, naming the file, if it cannot
/// be opened, is far longer than `max_bytes` (the memory limit of its densities), or would need more memory
/// or deeper recursion than any scan. Call only within `with_dicom_stack`.
std::optional<DicomData> load_dicom(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Runs `work` on a separate thread, waits for it, and passes its exceptions on. DCMTK parses and destroys
/// nested sequences recursively; the thread's stack is large enough for any file that `load_dicom` accepts.
void with_dicom_stack(const std::function<void()>& work);

/// Returns whether a JPEG decoder has found damaged data in this thread since the last call. (Decoders
/// continue with damaged data and report it only in DCMTK's log.)
bool take_jpeg_error();

}  // namespace osteomill
