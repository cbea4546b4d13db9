#pragma once

#include <atomic>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

namespace osteomill {

/// While it lives, the calling thread's calls of makers' functions leave their names in a place that other
/// threads may read: null while there is none under way. A caller that waits for the thread then knows for
/// which call.
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

/// A maker's library that is opened when it is wanted, so that nothing of it is needed to build or to run
/// without the device. Its functions' addresses are good for as long as this lives.
class VendorLibrary {
 public:
  /// Opens the file that the environment's `variable` names, else the first of `names` that the system has.
  /// Throws InputError about `device` if there is none.
  VendorLibrary(std::string device, const char* variable, std::initializer_list<const char*> names);

  /// A function, of whatever type it is put into a VendorFunction of.
  struct Function {
    const char* name;
    void* address;
  };
  /// Throws InputError if the library has none of that name, which lives as long as the program.
  Function operator[](const char* name) const;

 private:
  std::string device_;
  std::string file_;
  std::shared_ptr<void> library_;
};

/// A function of a maker's library.
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
