#pragma once

#include <initializer_list>
#include <memory>
#include <string>

namespace osteomill {

/// A maker's library that is opened when it is wanted, so that nothing of it is needed to build or to run
/// without the device. Its functions' addresses are good for as long as this lives.
class VendorLibrary {
 public:
  /// Opens the file that the environment's `variable` names, else the first of `names` that the system has.
  /// Throws InputError about `device` where there is none.
  VendorLibrary(std::string device, const char* variable, std::initializer_list<const char*> names);

  /// Throws InputError where the library has none of that name.
  template <typename Function>
  Function* function(const char* name) const {
    return reinterpret_cast<Function*>(address(name));
  }

 private:
  void* address(const char* name) const;

  std::string device_;
  std::string file_;
  std::shared_ptr<void> library_;
};

}  // namespace osteomill
