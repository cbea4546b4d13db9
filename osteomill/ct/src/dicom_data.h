#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

class DcmFileFormat;

namespace osteomill {

/// A DICOM file as DCMTK reads it: its elements, with long values (the pixels) left in the file until they
/// are asked for.
struct DicomData {
  std::shared_ptr<DcmFileFormat> file;
  /// The file is cut short or damaged; elements read before that stand.
  bool damaged = false;
  /// The UID of the transfer syntax in which its pixels are, whatever the file says.
  std::string syntax{};
  /// The transfer syntax if it is one that nothing here decodes; else empty.
  std::string undecodable{};
};

/// Reads a DICOM file; nothing if it is not DICOM at all. Throws InputError naming the file if it
/// cannot be opened, is far longer than `max_bytes` (the memory that its densities may take), or would take
/// more memory or deeper recursion than any scan does. To be called only within `with_dicom_stack`.
std::optional<DicomData> load_dicom(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Runs `work` on a thread of its own, waits for it, and hands on what it throws. DCMTK goes down into
/// sequences, and clears them away again, by recursion; its stack here is enough for any file that
/// `load_dicom` lets through.
void with_dicom_stack(const std::function<void()>& work);

/// Returns whether a JPEG decoder has found damaged data in this thread since this was last called. (Such a
/// decoder goes on with what it has, and says so only in DCMTK's log.)
bool take_jpeg_complaint();

}  // namespace osteomill
