// Preloaded library (LD_PRELOAD) in which file locks fail, as on NFS or Lustre mounted without them.
#include <cerrno>
#include <cstdlib>

extern "C" int flock(int, int) {
  const char* const asked = std::getenv("OSTEOMILL_LOCK_ERRNO");
  errno = asked == nullptr ? ENOLCK : std::atoi(asked);
  return -1;
}
