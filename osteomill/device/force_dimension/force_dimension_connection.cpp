#include <array>
#include <charconv>
#include <chrono>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "osteomill/device/hardware.h"
#include "osteomill/device/vendor_library.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// The library speaks of m and N m.
constexpr double kMmPerM = 1000;
// Twice as often as wrenches change; the library itself does not wait for the device.
constexpr auto kBetweenReadings = 500us;
// What dhd functions return: 0 done, below 0 failed; above 0 done, but the pose is the last one again.
constexpr int kNotNew = 1;

// The functions of libdhd 3 that are used, as their manual declares them. A device's number is -1 for the one
// opened last.
struct Dhd {
  explicit Dhd(const VendorLibrary& library)
      : device_count(library.function<int()>("dhdGetDeviceCount")),
        open(library.function<int(char)>("dhdOpenID")),
        close(library.function<int(char)>("dhdClose")),
        stop(library.function<int(char)>("dhdStop")),
        last_error(library.function<const char*()>("dhdErrorGetLastStr")),
        system_name(library.function<const char*(char)>("dhdGetSystemName")),
        system_type(library.function<int(char)>("dhdGetSystemType")),
        serial_number(library.function<int(unsigned short*, char)>("dhdGetSerialNumber")),
        has_wrist(library.function<bool(char)>("dhdHasWrist")),
        has_active_wrist(library.function<bool(char)>("dhdHasActiveWrist")),
        set_brakes(library.function<int(int, char)>("dhdSetBrakes")),
        enable_force(library.function<int(unsigned char, char)>("dhdEnableForce")),
        set_max_force(library.function<int(double, char)>("dhdSetMaxForce")),
        pose(library.function<int(double*, double*, double*, double (*)[3], char)>(
            "dhdGetPositionAndOrientationFrame")),
        button_mask(library.function<unsigned(char)>("dhdGetButtonMask")),
        set_wrench(library.function<int(double, double, double, double, double, double, double, char)>(
            "dhdSetForceAndTorqueAndGripperForce")) {}

  int (*device_count)();
  int (*open)(char);
  int (*close)(char);
  int (*stop)(char);
  const char* (*last_error)();
  const char* (*system_name)(char);
  int (*system_type)(char);
  int (*serial_number)(unsigned short*, char);
  bool (*has_wrist)(char);
  bool (*has_active_wrist)(char);
  int (*set_brakes)(int, char);
  int (*enable_force)(unsigned char, char);
  int (*set_max_force)(double, char);
  int (*pose)(double*, double*, double*, double (*)[3], char);
  unsigned (*button_mask)(char);
  int (*set_wrench)(double, double, double, double, double, double, double, char);
};

// What the library does not say, from the makers' data sheets.
struct Model {
  int first_type, last_type;
  WrenchLimits limits;
};

Model model_of(int system_type) {
  const std::array models{
      Model{32, 37, {12, 0}},     // omega.3, .6 and .7
      Model{60, 60, {8, 0}},      // Falcon
      Model{63, 64, {20, 200}},   // delta.3 and .6
      Model{104, 107, {20, 400}}  // sigma.7
  };
  for (const Model& model : models) {
    if (model.first_type <= system_type && system_type <= model.last_type) return model;
  }
  return {0, 0, {8, 100}};
}

struct Library {
  VendorLibrary file{
      "dhd", "OSTEOMILL_DHD_LIBRARY", {"libdhd.so.3", "libdhd.so", "libdrd.so.3", "libdrd.so"}};
  Dhd dhd{file};
};

[[noreturn]] void fail(const std::string& reason) {
  throw InputError("dhd", reason);
}

char number_of(const std::string& address) {
  if (address.empty()) return 0;
  signed char number = -1;
  const auto [end, error] = std::from_chars(address.data(), address.data() + address.size(), number);
  if (error != std::errc() || end != address.data() + address.size() || number < 0)
    fail("'" + address + "' is not the number of a device");
  return static_cast<char>(number);
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
    id_ = static_cast<char>(dhd_.open(number));
    if (id_ < 0) fail(dhd_.last_error());
    const Model model = model_of(dhd_.system_type(id_));
    capabilities_.name = std::string("Force Dimension ") + dhd_.system_name(id_);
    if (unsigned short serial = 0; dhd_.serial_number(&serial, id_) >= 0)
      capabilities_.name += fmt::format(" {}", serial);
    capabilities_.sensed = dhd_.has_wrist(id_) ? 6 : 3;
    capabilities_.driven = dhd_.has_active_wrist(id_) ? 6 : 3;
    capabilities_.R_VD = Mat3{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    capabilities_.limits = model.limits;
    if (dhd_.set_brakes(0, id_) < 0 || dhd_.enable_force(1, id_) < 0 ||
        dhd_.set_max_force(model.limits.force_N, id_) < 0) {
      const std::string reason = dhd_.last_error();
      dhd_.close(id_);
      fail(reason);
    }
  }
  ~ForceDimensionConnection() override {
    write({});
    dhd_.stop(id_);
    dhd_.close(id_);
  }
  ForceDimensionConnection(const ForceDimensionConnection&) = delete;
  ForceDimensionConnection& operator=(const ForceDimensionConnection&) = delete;

  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  ConnectionStatus read(DeviceInput& input) override {
    const auto end = Clock::now() + 2ms;
    int result = kNotNew;
    Vec3 position_m;
    double frame[3][3];
    while (result > 0 && Clock::now() + kBetweenReadings < end) {
      std::this_thread::sleep_until(next_);
      next_ = Clock::now() + kBetweenReadings;
      result = dhd_.pose(&position_m.x(), &position_m.y(), &position_m.z(), frame, id_);
    }
    if (result != 0) return result < 0 ? ConnectionStatus::lost : ConnectionStatus::silent;
    input.X_DH = {kMmPerM * position_m, Quat::Identity()};
    if (capabilities_.sensed == 6) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R_DH(&frame[0][0]);
      input.X_DH.orientation = Quat(Mat3(R_DH)).normalized();
    }
    input.buttons = dhd_.button_mask(id_);
    return ConnectionStatus::fresh;
  }

  ConnectionStatus write(const Wrench& wrench_D) override {
    const Vec3& force_N = wrench_D.force_N;
    const Vec3 torque_Nm = capabilities_.driven == 6 ? Vec3(wrench_D.torque_Nmm / kMmPerM) : Vec3::Zero();
    const int result = dhd_.set_wrench(force_N.x(), force_N.y(), force_N.z(), torque_Nm.x(), torque_Nm.y(),
                                       torque_Nm.z(), 0, id_);
    return result < 0 ? ConnectionStatus::lost : ConnectionStatus::fresh;
  }

 private:
  Library library_;
  const Dhd& dhd_ = library_.dhd;
  char id_ = -1;
  DeviceCapabilities capabilities_;
  Clock::time_point next_ = Clock::now();
};

}  // namespace

std::unique_ptr<Connection> open_force_dimension(const std::string& address) {
  return std::make_unique<ForceDimensionConnection>(address);
}

// Without opening it, as that would take it from whoever has it.
FoundDevice find_force_dimension(const std::string& address) {
  try {
    const Library library;
    require_device(library.dhd, number_of(address));
    const int count = library.dhd.device_count();
    return {true, fmt::format("{} connected", count == 1 ? "a device" : fmt::format("{} devices", count))};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

}  // namespace osteomill
