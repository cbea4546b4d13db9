#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/latest_value.h"
#include "osteomill/base/real_time.h"
#include "osteomill/session/hardware.h"

#include "device/vendor_library.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Constants of libHD 3, from its reference: parameters, and return values of a callback.
enum Parameter : unsigned {
  kCurrentButtons = 0x2000,
  kCurrentTransform = 0x2052,
  kDeviceModelType = 0x2501,
  kDeviceSerialNumber = 0x2504,
  kInputDof = 0x2553,
  kOutputDof = 0x2554,
  kCalibrationStyle = 0x2555,
  kNominalMaxForce = 0x2603,
  kNominalMaxTorque = 0x2622,
  kCurrentForce = 0x2700,
  kCurrentTorque = 0x2701,
  kForceOutput = 0x4000,
};
constexpr unsigned kInvalidHandle = 0xffffffff;
constexpr unsigned kContinue = 1;
constexpr unsigned kCalibrated = 0x5000;
constexpr unsigned kCalibratesItself = 0x5001;
// Calibration styles that the program can run by itself (the operator only uses the inkwell), unlike an
// encoder reset.
constexpr unsigned kByItself = 1 << 1;
constexpr unsigned kByInkwell = 1 << 2;
constexpr unsigned short kDefaultPriority = 0xffff / 2;
// Error codes 0x02.. concern forces (warm motors, excessive force or velocity); the device keeps running.
constexpr bool is_of_force(unsigned code) {
  return code >> 8 == 2;
}

// A wrench older than this is replaced by zero. Not a watchdog of the device: it runs in the library's
// thread, which ends with the program.
constexpr auto kWrenchTimeout = 20ms;
constexpr auto kPollPeriod = 200us;
constexpr double kFrame_s = 1e-3;

struct HdError {
  unsigned code;
  int internal_code;
  unsigned device;
};

struct Hd {
  VendorLibrary file{"hd", "OSTEOMILL_HD_LIBRARY", {"libHD.so", "libHD.so.3.4", "libHD.so.3"}};
  VendorFunction<unsigned(const char*)> init_device = file["hdInitDevice"];
  VendorFunction<void(unsigned)> disable_device = file["hdDisableDevice"];
  VendorFunction<void(unsigned)> begin_frame = file["hdBeginFrame"];
  VendorFunction<void(unsigned)> end_frame = file["hdEndFrame"];
  VendorFunction<void(unsigned, double*)> get_doubles = file["hdGetDoublev"];
  VendorFunction<void(unsigned, const double*)> set_doubles = file["hdSetDoublev"];
  VendorFunction<void(unsigned, int*)> get_integers = file["hdGetIntegerv"];
  VendorFunction<const char*(unsigned)> get_string = file["hdGetString"];
  VendorFunction<void(unsigned)> enable = file["hdEnable"];
  VendorFunction<unsigned()> check_calibration = file["hdCheckCalibration"];
  VendorFunction<void(unsigned)> update_calibration = file["hdUpdateCalibration"];
  VendorFunction<HdError()> get_error = file["hdGetError"];
  VendorFunction<const char*(unsigned)> error_string = file["hdGetErrorString"];
  VendorFunction<unsigned long(unsigned (*)(void*), void*, unsigned short)> schedule =
      file["hdScheduleAsynchronous"];
  VendorFunction<void(unsigned long)> unschedule = file["hdUnschedule"];
  VendorFunction<void()> start_scheduler = file["hdStartScheduler"];
  VendorFunction<void()> stop_scheduler = file["hdStopScheduler"];
};

// An opened device whose motors are not powered.
struct OpenedDevice {
  explicit OpenedDevice(const std::string& address)
      : handle(hd.init_device(address.empty() ? nullptr : address.c_str())) {
    if (const unsigned code = hd.get_error().code; code != 0 || handle == kInvalidHandle)
      throw InputError("hd", reason_of(code, "the device cannot be opened"));
  }
  ~OpenedDevice() { hd.disable_device(handle); }
  OpenedDevice(const OpenedDevice&) = delete;
  OpenedDevice& operator=(const OpenedDevice&) = delete;

  // Returns the library's reason for an error code, or `otherwise` if it has none.
  std::string reason_of(unsigned code, const char* otherwise) const {
    const char* const reason = code == 0 ? nullptr : hd.error_string(code);
    return reason == nullptr ? otherwise : reason;
  }
  int integer(unsigned parameter) const {
    int value = 0;
    hd.get_integers(parameter, &value);
    return value;
  }
  std::string name() const {
    const auto string_of = [&](unsigned parameter) {
      const char* const text = hd.get_string(parameter);
      return std::string(text == nullptr ? "" : text);
    };
    return fmt::format("3D Systems {} {}", string_of(kDeviceModelType), string_of(kDeviceSerialNumber));
  }

  Hd hd;
  unsigned handle;
};

struct SentWrench {
  Wrench wrench;
  Clock::time_point time{};
  // Number of the wrench; consecutive zeros share one.
  unsigned number = 0;
};

class TouchConnection final : public Connection {
 public:
  explicit TouchConnection(const std::string& address) : device_(address) {
    read_capabilities();
    frames_ = hd_.schedule([](void* self) { return static_cast<TouchConnection*>(self)->frame(); }, this,
                           kDefaultPriority);
    {
      // Signals are blocked in the library's thread, so that it keeps running while another thread handles
      // one.
      const BlockedSignals start_with_none;
      hd_.start_scheduler();
    }
    if (const unsigned code = hd_.get_error().code; code != 0) {
      const std::string reason = device_.reason_of(code, "the scheduler does not start");
      close();
      throw InputError("hd", reason);
    }
  }
  ~TouchConnection() override {
    // Waits at most 20 ms: if the library hangs, no frame sends the zero.
    for (const auto end = Clock::now() + 20ms; !send({}) && Clock::now() < end;)
      std::this_thread::sleep_for(kPollPeriod);
    close();
  }

  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  ConnectionStatus read(DeviceInput& input) override {
    const auto end = Clock::now() + 2ms;
    while (frames_done_.load(std::memory_order_acquire) == frames_seen_) {
      if (is_lost_.load(std::memory_order_relaxed)) return ConnectionStatus::lost;
      if (Clock::now() + kPollPeriod > end) return ConnectionStatus::silent;
      std::this_thread::sleep_for(kPollPeriod);
    }
    frames_seen_ = frames_done_.load(std::memory_order_acquire);
    input = input_.read();
    return ConnectionStatus::fresh;
  }

  ConnectionStatus write(const Wrench& wrench_B) override {
    if (is_lost_.load(std::memory_order_relaxed)) return ConnectionStatus::lost;
    // At most one wrench per frame, because the previous one may not have been sent yet.
    const unsigned frames = frames_done_.load(std::memory_order_acquire);
    if (frames == frames_at_writing_) return ConnectionStatus::silent;
    frames_at_writing_ = frames;
    return send(wrench_B) ? ConnectionStatus::fresh : ConnectionStatus::silent;
  }

 private:
  // Returns false if `wrench_B` is zero and the motors have not received it yet; otherwise true.
  bool send(const Wrench& wrench_B) {
    const bool zero = is_zero(wrench_B);
    if (!zero || !sends_zero_) ++number_;
    sends_zero_ = zero;
    sent_.write({wrench_B, Clock::now(), number_});
    return !zero || zero_of_.load(std::memory_order_acquire) == number_;
  }

  void read_capabilities() {
    capabilities_.name = device_.name();
    capabilities_.sensed = device_.integer(kInputDof) >= 6 ? 6 : 3;
    capabilities_.driven = device_.integer(kOutputDof) >= 6 ? 6 : 3;
    const auto styles = static_cast<unsigned>(device_.integer(kCalibrationStyle));
    calibration_style_ = (styles & kByItself) != 0 ? kByItself : styles & kByInkwell;
    double force_N = 0, torque_Nmm = 0;
    hd_.get_doubles(kNominalMaxForce, &force_N);
    if (capabilities_.driven == 6) hd_.get_doubles(kNominalMaxTorque, &torque_Nmm);
    capabilities_.limits = {force_N, torque_Nmm};
  }

  // One servo tick, called at 1 kHz by the library's thread.
  unsigned frame() {
    hd_.begin_frame(device_.handle);
    DeviceInput input;
    // Column-major as in OpenGL; mm.
    std::array<double, 16> transform{};
    hd_.get_doubles(kCurrentTransform, transform.data());
    const Eigen::Map<const Eigen::Matrix4d> X_BH(transform.data());
    input.X_BH.position_mm = X_BH.topRightCorner<3, 1>();
    if (capabilities_.sensed == 6) input.X_BH.orientation = rotation_of(X_BH.topLeftCorner<3, 3>());
    int buttons = 0;
    hd_.get_integers(kCurrentButtons, &buttons);
    input.buttons = static_cast<unsigned>(buttons);
    input.not_driven = why_not_driven();

    const SentWrench& sent = sent_.read();
    const bool is_driven = input.not_driven == nullptr && Clock::now() - sent.time < kWrenchTimeout;
    driven_ = approach(driven_, is_driven ? sent.wrench : Wrench{}, kHandWrenchRates, kFrame_s);
    hd_.set_doubles(kCurrentForce, driven_.force_N.data());
    if (capabilities_.driven == 6) hd_.set_doubles(kCurrentTorque, driven_.torque_Nmm.data());
    hd_.end_frame(device_.handle);
    if (is_zero(driven_)) zero_of_.store(sent.number, std::memory_order_release);
    if (const unsigned code = hd_.get_error().code; code != 0 && !is_of_force(code)) {
      is_lost_.store(true, std::memory_order_relaxed);
      return kContinue;
    }
    input_.write(input);
    frames_done_.fetch_add(1, std::memory_order_release);
    return kContinue;
  }

  // Returns why the device may not be driven, or null. Powers the motors once it is calibrated. Call within a
  // frame.
  const char* why_not_driven() {
    const unsigned calibration = hd_.check_calibration();
    if (calibration == kCalibratesItself && calibration_style_ != 0) {
      hd_.update_calibration(calibration_style_);
      // Clears the error of a failed calibration; the next frame tries again.
      hd_.get_error();
    }
    if (calibration != kCalibrated)
      return "is not calibrated: put its stylus into the inkwell, or calibrate it with the vendor's tool";
    if (!has_power_) hd_.enable(kForceOutput);
    has_power_ = true;
    return nullptr;
  }

  void close() {
    hd_.stop_scheduler();
    hd_.unschedule(frames_);
  }

  OpenedDevice device_;
  const Hd& hd_ = device_.hd;
  unsigned calibration_style_ = 0;
  unsigned long frames_ = 0;
  // Used by the servo thread only.
  bool has_power_ = false;
  Wrench driven_;
  DeviceCapabilities capabilities_;
  LatestValue<DeviceInput> input_;
  LatestValue<SentWrench> sent_;
  std::atomic<unsigned> frames_done_{0};
  unsigned frames_seen_ = 0;
  unsigned frames_at_writing_ = ~0U;
  unsigned number_ = 0;
  bool sends_zero_ = true;
  // Number of the wrench in the last frame that sent zero.
  std::atomic<unsigned> zero_of_{0};
  std::atomic<bool> is_lost_{false};
};

}  // namespace

std::unique_ptr<Connection> open_touch(const std::string& address) {
  return std::make_unique<TouchConnection>(address);
}

std::string probe_touch(const std::string& address) {
  return OpenedDevice(address).name();
}

}  // namespace osteomill
