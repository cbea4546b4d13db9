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

  /// A function, of whatever type it is put into a pointer of.
  struct Function {
    void* address;
    template <typename Type>
    operator Type*() const {
      return reinterpret_cast<Type*>(address);
    }
  };
  /// Throws InputError where the library has none of that name.
  Function operator[](const char* name) const;

 private:
  std::string device_;
  std::string file_;
  std::shared_ptr<void> library_;
};

}  // namespace osteomill
