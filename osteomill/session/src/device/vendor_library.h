#pragma once

#include <atomic>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

namespace osteomill {

/// While it exists, the calling thread stores the name of the vendor function that it is in into `place`;
/// null outside such calls. Other threads can read it to report a call that hangs.
class VendorCallTracker {
 public:
  explicit VendorCallTracker(std::atomic<const char*>& place)
      : before_(std::exchange(current_call_, &place)) {}
  ~VendorCallTracker() { current_call_ = before_; }
  VendorCallTracker(const VendorCallTracker&) = delete;
  VendorCallTracker& operator=(const VendorCallTracker&) = delete;

 private:
  template <typename Signature>
  friend class VendorFunction;
  static void name(const char* function) noexcept {
    if (current_call_ != nullptr) current_call_->store(function, std::memory_order_release);
  }
  static inline thread_local std::atomic<const char*>* current_call_ = nullptr;
  std::atomic<const char*>* before_;
};

/// A vendor library loaded at run time, so that it is not needed to build or to run without the device.
/// Function addresses are valid during its lifetime.
class VendorLibrary {
 public:
  /// Loads the file named by the environment variable `variable`, otherwise the first of `names` that can be
  /// loaded. Throws InputError about `device` if there is none.
  VendorLibrary(std::string device, const char* variable, std::initializer_list<const char*> names);

  /// An untyped function; VendorFunction gives it its signature.
  struct Function {
    const char* name;
    void* address;
  };
  /// Returns the function. Throws InputError if the library does not have it. `name` must have static
  /// lifetime.
  Function operator[](const char* name) const;

 private:
  std::string device_;
  std::string file_;
  std::shared_ptr<void> library_;
};

/// A function of a vendor library.
template <typename Signature>
class VendorFunction;
template <typename Result, typename... Arguments>
class VendorFunction<Result(Arguments...)> {
 public:
  VendorFunction(const VendorLibrary::Function& found)
      : name_(found.name), function_(reinterpret_cast<Result (*)(Arguments...)>(found.address)) {}

  Result operator()(Arguments... arguments) const {
    struct Named {
      explicit Named(const char* name) { VendorCallTracker::name(name); }
      ~Named() { VendorCallTracker::name(nullptr); }
    };
    const Named named(name_);
    return function_(arguments...);
  }

 private:
  const char* name_;
  Result (*function_)(Arguments...);
};

}  // namespace osteomill
