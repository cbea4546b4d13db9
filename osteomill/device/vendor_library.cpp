#include "osteomill/device/vendor_library.h"

#include <cstdlib>
#include <utility>

#include <dlfcn.h>
#include <fmt/core.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

std::shared_ptr<void> opened(const char* file) {
  void* const library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  return library == nullptr ? nullptr : std::shared_ptr<void>(library, dlclose);
}

}  // namespace

VendorLibrary::VendorLibrary(std::string device, const char* variable,
                             std::initializer_list<const char*> names)
    : device_(std::move(device)) {
  if (const char* const named = std::getenv(variable); named != nullptr && *named != '\0') {
    file_ = named;
    library_ = opened(named);
    if (!library_) throw InputError(device_, dlerror());
    return;
  }
  for (const char* name : names) {
    file_ = name;
    library_ = opened(name);
    if (library_) return;
  }
  throw InputError(device_, fmt::format("{} of the maker's software is not installed; {} may name it",
                                        *names.begin(), variable));
}

void* VendorLibrary::address(const char* name) const {
  void* const found = dlsym(library_.get(), name);
  if (found == nullptr) throw InputError(device_, fmt::format("{} has no {}", file_, name));
  return found;
}

}  // namespace osteomill
