#include "osteomill/recording/hdf5_handle.h"

namespace osteomill {

namespace {

std::mutex& hdf5_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Hdf5Lock::Hdf5Lock() : lock_(hdf5_mutex()) {
  // All that is open is closed by its handle. What the library would do at exit crashes on a file that a full
  // disk left half-written. Before any other call, or it has no effect.
  [[maybe_unused]] static const herr_t asked = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace osteomill
