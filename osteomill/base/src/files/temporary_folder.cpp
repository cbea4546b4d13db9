#include "osteomill/base/temporary_folder.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <stdlib.h>

#include "osteomill/base/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  if (error) throw InputError("TMPDIR", "is not a usable folder for temporary files: " + error.message());
  std::string name = (parent / "osteomill-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw InputError(parent.string(), std::string("cannot hold a temporary folder: ") + std::strerror(errno));
  }
  path_ = name;
  cleanup_.emplace(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace osteomill
