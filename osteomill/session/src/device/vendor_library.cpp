#include "device/vendor_library.h"

#include <cstdlib>
#include <utility>

#include <dlfcn.h>
#include <fmt/core.h>

#include "osteomill/base/input_error.h"

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
  // Reports a file that exists but lacks a library that it needs before one that does not exist.
  std::string why;
  for (const char* name : names) {
    file_ = name;
    library_ = opened(name);
    if (library_) return;
    const std::string reason = dlerror();
    if (!reason.starts_with(std::string(name) + ": cannot open shared object file")) why = reason;
  }
  throw InputError(device_, why.empty() ? fmt::format("{} of the vendor's software is not installed; {} can "
                                                      "name its path",
                                                      *names.begin(), variable)
                                        : "the vendor's software cannot be loaded: " + why);
}

VendorLibrary::Function VendorLibrary::operator[](const char* name) const {
  void* const found = dlsym(library_.get(), name);
  if (found == nullptr) throw InputError(device_, fmt::format("{} has no {}", file_, name));
  return {name, found};
}

}  // namespace osteomill
