// Loaded before the system's own (LD_PRELOAD): locks fail as on NFS or Lustre that is mounted without them.
#include <cerrno>
#include <cstdlib>

extern "C" int flock(int, int) {
  const char* const asked = std::getenv("OSTEOMILL_LOCK_ERRNO");
  errno = asked == nullptr ? ENOLCK : std::atoi(asked);
  return -1;
}
