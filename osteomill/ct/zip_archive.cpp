#include "osteomill/ct/zip_archive.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <minizip/unzip.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/input_files.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxFiles = 1 << 16;

struct Close {
  void operator()(void* archive) const { unzClose(archive); }
};

class ZipReader {
 public:
  ZipReader(const fs::path& path, std::uint64_t max_bytes)
      : path_(path), left_bytes_(max_bytes), max_bytes_(max_bytes), archive_(unzOpen64(path.c_str())) {
    if (archive_ == nullptr) throw damaged();
  }

  void unpack_into(const fs::path& folder);

 private:
  InputError fault(const std::string& reason) const { return {path_.string(), reason}; }
  InputError damaged() const {
    return fault("is a zip archive that is damaged, or packed in a way that is not known");
  }
  fs::path name_here(unz_file_info64& info) const;
  void unpack_here(const fs::path& file);

  fs::path path_;
  std::uint64_t left_bytes_;
  std::uint64_t max_bytes_;
  std::unique_ptr<std::remove_pointer_t<unzFile>, Close> archive_;
  std::vector<char> block_ = std::vector<char>(1 << 18);
};

// Some archives part folders by backslashes.
fs::path ZipReader::name_here(unz_file_info64& info) const {
  std::string name(4096, '\0');
  if (unzGetCurrentFileInfo64(archive_.get(), &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) !=
      UNZ_OK)
    throw damaged();
  name.resize(std::min<std::size_t>(name.find('\0'), info.size_filename));
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path relative(name);
  if (relative.is_absolute() || std::find(relative.begin(), relative.end(), "..") != relative.end())
    throw fault("holds a file whose name leads out of it");
  return relative;
}

void ZipReader::unpack_here(const fs::path& file) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  if (unzOpenCurrentFile(archive_.get()) != UNZ_OK) throw damaged();
  int count = 0;
  while ((count = unzReadCurrentFile(archive_.get(), block_.data(), static_cast<unsigned>(block_.size()))) >
         0) {
    if (static_cast<std::uint64_t>(count) > left_bytes_) {
      throw fault(fmt::format("unpacks to over the {:.3g} GB that it may take",
                              static_cast<double>(max_bytes_) * 1e-9));
    }
    left_bytes_ -= static_cast<std::uint64_t>(count);
    out.write(block_.data(), count);
    WorkProgress::done(0);
  }
  // The checksum is looked at when a file is closed.
  if (count < 0 || unzCloseCurrentFile(archive_.get()) != UNZ_OK) throw damaged();
  out.close();
  if (!out)
    throw fault(fmt::format("cannot be unpacked to {} (is the disk full?)", file.parent_path().string()));
}

void ZipReader::unpack_into(const fs::path& folder) {
  std::uint64_t files = 0;
  for (int state = unzGoToFirstFile(archive_.get()); state != UNZ_END_OF_LIST_OF_FILE;
       state = unzGoToNextFile(archive_.get())) {
    if (state != UNZ_OK) throw damaged();
    if (++files > kMaxFiles) throw fault(fmt::format("holds over {} files", kMaxFiles));
    unz_file_info64 info{};
    const fs::path name = name_here(info);
    if ((info.flag & 1) != 0) throw fault("is encrypted");
    if (name.has_filename()) unpack_here(folder / name);
  }
}

}  // namespace

bool is_zip(const fs::path& file) {
  std::string head(4, '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), 4);
  return head == "PK\3\4";
}

void unpack_zip(const fs::path& archive, const fs::path& folder, std::uint64_t max_bytes) {
  note_input(archive);
  try {
    ZipReader(archive, max_bytes).unpack_into(folder);
  } catch (const fs::filesystem_error& error) {
    throw InputError(archive.string(), "cannot be unpacked: " + error.code().message());
  }
}

}  // namespace osteomill
