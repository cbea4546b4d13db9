#include "osteomill/recording/pipe_end.h"

#include <stdexcept>

#include <unistd.h>

namespace osteomill {

namespace {

void require_intact_pipe(bool whole) {
  if (!whole) throw std::runtime_error("the pipe to the child is broken");
}

}  // namespace

PipeEnd::PipeEnd(int descriptor, Direction direction, std::uintmax_t max_bytes)
    : file_(::fdopen(descriptor, direction == Direction::read ? "r" : "w")),
      direction_(direction),
      max_bytes_(max_bytes) {
  if (file_ == nullptr) ::close(descriptor);
  require_intact_pipe(file_ != nullptr);
}

PipeEnd::~PipeEnd() {
  std::fclose(file_);
}

void PipeEnd::pass_bytes(void* data, std::size_t count) {
  // An empty container may have no memory.
  if (count == 0) return;
  require_intact_pipe(
      (is_reading() ? std::fread(data, 1, count, file_) : std::fwrite(data, 1, count, file_)) == count);
}

std::size_t PipeEnd::pass_count(std::size_t count, std::size_t size) {
  pass_bytes(&count, sizeof(count));
  require_intact_pipe(count <= max_bytes_ / size);
  return count;
}

void PipeEnd::flush() {
  require_intact_pipe(std::fflush(file_) == 0);
}

}  // namespace osteomill
