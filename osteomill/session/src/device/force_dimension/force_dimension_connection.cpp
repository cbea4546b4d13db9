#include <array>
#include <chrono>
#include <thread>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/session/hardware.h"

#include "device/vendor_library.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// The library uses m and N m.
constexpr double kMmPerM = 1000;
// Polling interval: twice the rate at which wrenches change. The library's read does not wait for the device.
constexpr auto kPollInterval = 500us;
constexpr auto kBetweenStatuses = 20ms;
// dhd functions return 0 on success, a negative value on failure, and a positive value on success without a
// new pose.
constexpr int kNoNewFrame = 1;
// Watchdog timeout in steps of 125 us; the maximum. The watchdog starts with the first wrench.
constexpr unsigned char kWatchdog = 255;
constexpr double kWatchdogStep_s = 125e-6;

// Indices into the status array, and causes of a force that is off.
constexpr std::size_t kStatuses = 17;
enum Status : std::size_t { kIsReset = 3, kHasForce = 5, kBrakes = 6, kForceOffCause = 14 };
using StatusOfDevice = std::array<int, kStatuses>;
constexpr int kByWatchdog = 3;
constexpr int kByProgram = 4;
constexpr std::array kForceIsOff{"has its force off: switch it on by the device's button",
                                 "has its force off by its button: press it again",
                                 "has braked because it moved too fast: switch its force on by its button",
                                 "has its force off because it received no wrench in time",
                                 "has its force off by another program",
                                 "has its force off because it was unplugged: switch it on by its button",
                                 "has its force off: hold its dead man's switch"};

// Functions of libdhd 3, declared as in its manual. Device number -1 means the device opened last.
struct Dhd {
  VendorLibrary file{
      "dhd", "OSTEOMILL_DHD_LIBRARY", {"libdhd.so.3", "libdhd.so", "libdrd.so.3", "libdrd.so"}};
  VendorFunction<int()> device_count = file["dhdGetDeviceCount"];
  VendorFunction<int(char)> open = file["dhdOpenID"];
  VendorFunction<int(char)> close = file["dhdClose"];
  VendorFunction<int(char)> stop = file["dhdStop"];
  VendorFunction<const char*()> last_error = file["dhdErrorGetLastStr"];
  VendorFunction<const char*(char)> system_name = file["dhdGetSystemName"];
  VendorFunction<int(char)> system_type = file["dhdGetSystemType"];
  VendorFunction<int(unsigned short*, char)> serial_number = file["dhdGetSerialNumber"];
  VendorFunction<bool(char)> has_wrist = file["dhdHasWrist"];
  VendorFunction<bool(char)> has_active_wrist = file["dhdHasActiveWrist"];
  VendorFunction<bool(char)> has_gripper = file["dhdHasGripper"];
  VendorFunction<int(unsigned char, char)> emulate_button = file["dhdEmulateButton"];
  VendorFunction<int()> enable_expert_mode = file["dhdEnableExpertMode"];
  VendorFunction<int()> disable_expert_mode = file["dhdDisableExpertMode"];
  VendorFunction<int(unsigned char, char)> set_watchdog = file["dhdSetWatchdog"];
  VendorFunction<int(unsigned char*, char)> get_watchdog = file["dhdGetWatchdog"];
  VendorFunction<int(int*, char)> status = file["dhdGetStatus"];
  VendorFunction<int(int, char)> set_brakes = file["dhdSetBrakes"];
  VendorFunction<int(unsigned char, char)> enable_force = file["dhdEnableForce"];
  VendorFunction<int(double, char)> set_max_force = file["dhdSetMaxForce"];
  VendorFunction<int(double, char)> set_max_torque = file["dhdSetMaxTorque"];
  VendorFunction<int(double*, double*, double*, double (*)[3], char)> pose =
      file["dhdGetPositionAndOrientationFrame"];
  VendorFunction<unsigned(char)> button_mask = file["dhdGetButtonMask"];
  VendorFunction<int(double, double, double, double, double, double, double, char)> set_wrench =
      file["dhdSetForceAndTorqueAndGripperForce"];
};

// Limits from the vendors' data sheets; the library does not report them.
struct Model {
  int first_type, last_type;
  WrenchLimits limits;
};

Model model_of(int system_type) {
  const std::array models{
      Model{32, 37, {12, 0}},      // omega.3, .6 and .7
      Model{60, 60, {8, 0}},       // Falcon
      Model{63, 64, {20, 200}},    // delta.3 and .6
      Model{104, 107, {20, 400}},  // sigma.7
      Model{108, 109, {12, 200}},  // lambda.7
      Model{131, 132, {12, 0}},    // lambda.6
      Model{203, 203, {12, 0}},    // lambda.3
      Model{206, 206, {20, 0}}     // sigma.3
  };
  for (const Model& model : models) {
    if (model.first_type <= system_type && system_type <= model.last_type) return model;
  }
  return {0, 0, {8, 100}};
}

[[noreturn]] void fail(const std::string& reason) {
  throw InputError("dhd", reason);
}

char number_of(const std::string& address) {
  if (address.empty()) return 0;
  const auto number = parse_number<signed char>(address);
  if (!number || *number < 0) fail("'" + address + "' is not the number of a device");
  return static_cast<char>(*number);
}

void require_device(const Dhd& dhd, char number) {
  const int count = dhd.device_count();
  if (count < 0) fail(dhd.last_error());
  if (count == 0) fail("no device is connected");
  if (number >= count)
    fail(fmt::format("there is no device {}, the last of {} is {}", int{number}, count, count - 1));
}

class ForceDimensionConnection final : public Connection {
 public:
  explicit ForceDimensionConnection(const std::string& address) {
    const char number = number_of(address);
    require_device(dhd_, number);
    const int opened = dhd_.open(number);
    if (opened < 0) fail(dhd_.last_error());
    id_ = static_cast<char>(opened);
    const Model model = model_of(dhd_.system_type(id_));
    const char* const model_name = dhd_.system_name(id_);
    capabilities_.name = fmt::format("Force Dimension {}", model_name == nullptr ? "device" : model_name);
    if (unsigned short serial = 0; dhd_.serial_number(&serial, id_) >= 0)
      capabilities_.name += fmt::format(" {}", serial);
    capabilities_.sensed = dhd_.has_wrist(id_) ? 6 : 3;
    capabilities_.driven = dhd_.has_active_wrist(id_) ? 6 : 3;
    capabilities_.R_VB = Mat3{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    capabilities_.limits = model.limits;
    // Also after reopening: force that the operator or the brakes switched off may only be switched on by the
    // operator.
    StatusOfDevice found{};
    may_enable_force_ = dhd_.status(found.data(), id_) < 0 || !is_off(found) || found[kForceOffCause] == 0 ||
                        found[kForceOffCause] == kByWatchdog || found[kForceOffCause] == kByProgram;
    if (dhd_.enable_force(0, id_) < 0 || dhd_.set_max_force(model.limits.force_N, id_) < 0 ||
        dhd_.set_max_torque(model.limits.torque_Nmm / kMmPerM, id_) < 0) {
      const std::string reason = dhd_.last_error();
      dhd_.close(id_);
      fail(reason);
    }
    if (dhd_.has_gripper(id_)) dhd_.emulate_button(1, id_);
    set_watchdog();
  }
  ~ForceDimensionConnection() override {
    write({});
    dhd_.stop(id_);
    dhd_.close(id_);
  }

  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  ConnectionStatus read(DeviceInput& input) override {
    const auto end = Clock::now() + 2ms;
    int result = kNoNewFrame;
    Vec3 position_m;
    double frame[3][3];
    while (result > 0 && Clock::now() + kPollInterval < end) {
      std::this_thread::sleep_until(next_);
      next_ = Clock::now() + kPollInterval;
      result = dhd_.pose(&position_m.x(), &position_m.y(), &position_m.z(), frame, id_);
    }
    if (result != 0) return result < 0 ? ConnectionStatus::lost : ConnectionStatus::silent;
    input.X_BH = {kMmPerM * position_m, Quat::Identity()};
    if (capabilities_.sensed == 6) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R_BH(&frame[0][0]);
      input.X_BH.orientation = rotation_of(R_BH);
    }
    input.buttons = dhd_.button_mask(id_);
    if (Clock::now() >= next_status_) {
      next_status_ = Clock::now() + kBetweenStatuses;
      not_driven_ = why_not_driven();
    }
    input.not_driven = not_driven_;
    return ConnectionStatus::fresh;
  }

  ConnectionStatus write(const Wrench& wrench_B) override {
    const Vec3& force_N = wrench_B.force_N;
    const Vec3 torque_Nm = capabilities_.driven == 6 ? Vec3(wrench_B.torque_Nmm / kMmPerM) : Vec3::Zero();
    sends_zero_ = is_zero(wrench_B);
    const int result = dhd_.set_wrench(force_N.x(), force_N.y(), force_N.z(), torque_Nm.x(), torque_Nm.y(),
                                       torque_Nm.z(), 0, id_);
    return result < 0 ? ConnectionStatus::lost : ConnectionStatus::fresh;
  }

 private:
  Dhd dhd_;
  // Does nothing on devices without a watchdog.
  void set_watchdog() {
    dhd_.enable_expert_mode();
    dhd_.set_watchdog(kWatchdog, id_);
    unsigned char is_set = 0;
    if (dhd_.get_watchdog(&is_set, id_) >= 0) capabilities_.watchdog_s = kWatchdogStep_s * is_set;
    dhd_.disable_expert_mode();
  }

  static bool is_off(const StatusOfDevice& status) { return status[kHasForce] == 0 || status[kBrakes] != 0; }

  // Switches the force on once the device is calibrated, and again if only the watchdog had switched it off.
  // In the latter case it first reports the force as off and waits until the wrench is zero, because the
  // device resumes with the last wrench sent.
  const char* why_not_driven() {
    StatusOfDevice status{};
    if (dhd_.status(status.data(), id_) < 0) return "does not report whether it is calibrated";
    if (status[kIsReset] != 0) {
      may_enable_force_ = true;
      return "is not calibrated: calibrate it with the vendor's tool (HapticInit), a Falcon by hand";
    }
    const auto cause = static_cast<std::size_t>(status[kForceOffCause]);
    const char* const off = is_off(status) ? kForceIsOff[cause < kForceIsOff.size() ? cause : 0] : nullptr;
    const bool by_watchdog = cause == kByWatchdog && not_driven_ == off && sends_zero_;
    if (off != nullptr && (may_enable_force_ || by_watchdog)) {
      may_enable_force_ = false;
      dhd_.set_brakes(0, id_);
      dhd_.enable_force(1, id_);
      if (dhd_.status(status.data(), id_) < 0) return "does not report whether its force is on";
      return is_off(status) ? off : nullptr;
    }
    return off;
  }

  char id_ = 0;
  DeviceCapabilities capabilities_;
  Clock::time_point next_ = Clock::now();
  Clock::time_point next_status_ = Clock::now();
  const char* not_driven_ = nullptr;
  bool may_enable_force_ = true;
  bool sends_zero_ = true;
};

}  // namespace

std::unique_ptr<Connection> open_force_dimension(const std::string& address) {
  return std::make_unique<ForceDimensionConnection>(address);
}

// Does not open the device, because that would take it away from another program.
std::string probe_force_dimension(const std::string& address) {
  const Dhd dhd;
  require_device(dhd, number_of(address));
  const int count = dhd.device_count();
  return count == 1 ? "a device connected" : fmt::format("{} devices connected", count);
}

}  // namespace osteomill
