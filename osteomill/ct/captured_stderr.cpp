#include "osteomill/ct/captured_stderr.h"

#include <cstdio>

#include <sys/mman.h>
#include <unistd.h>

namespace osteomill {

CapturedStderr::CapturedStderr() {
  std::fflush(stderr);
  memory_ = ::memfd_create("osteomill-stderr", MFD_CLOEXEC);
  if (memory_ < 0) return;
  stderr_ = ::dup(STDERR_FILENO);
  if (stderr_ >= 0) ::dup2(memory_, STDERR_FILENO);
}

CapturedStderr::~CapturedStderr() {
  std::fflush(stderr);
  if (stderr_ >= 0) {
    ::dup2(stderr_, STDERR_FILENO);
    ::close(stderr_);
  }
  if (memory_ >= 0) ::close(memory_);
}

std::string CapturedStderr::text() const {
  std::fflush(stderr);
  std::string text(4096, '\0');
  const ssize_t count = memory_ < 0 ? 0 : ::pread(memory_, text.data(), text.size(), 0);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return text;
}

}  // namespace osteomill
