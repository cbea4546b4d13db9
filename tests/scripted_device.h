#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "osteomill/base/input_error.h"
#include "osteomill/session/connected_device.h"

namespace osteomill::testing_support {

/// Haptic hardware in simulated time with scripted faults. Logs the wrenches that its hand receives.
struct ScriptedDevice {
  struct Got {
    double at_s;
    Wrench wrench_B;
  };
  DeviceCapabilities can;
  double now_s = 10;
  DeviceInput input;
  /// Faults: gives no input; accepts no wrench; reports that it is lost but accepts wrenches; is disconnected
  /// and cannot be opened.
  bool silent = false;
  bool busy = false;
  bool reports_lost = false;
  bool gone = false;
  bool throws = false;
  std::vector<Got> got;
  int opened = 0;
  int closed = 0;

  ScriptedDevice() { can.name = "scripted"; }
  ScriptedDevice(const ScriptedDevice&) = delete;
  ScriptedDevice& operator=(const ScriptedDevice&) = delete;

  OpenConnection way() {
    return [this] { return std::make_unique<ScriptedConnection>(*this); };
  }
  std::function<double()> clock() {
    return [this] { return now_s; };
  }
  const Wrench& last() const { return got.back().wrench_B; }

  /// Returns the largest changes of force and torque between consecutive writes, 1 ms apart.
  Wrench largest_step() const {
    Wrench largest;
    for (std::size_t n = 1; n < got.size(); ++n) {
      const Vec3 force_N = got[n].wrench_B.force_N - got[n - 1].wrench_B.force_N;
      const Vec3 torque_Nmm = got[n].wrench_B.torque_Nmm - got[n - 1].wrench_B.torque_Nmm;
      if (force_N.norm() > largest.force_N.norm()) largest.force_N = force_N;
      if (torque_Nmm.norm() > largest.torque_Nmm.norm()) largest.torque_Nmm = torque_Nmm;
    }
    return largest;
  }

 private:
  class ScriptedConnection final : public Connection {
   public:
    explicit ScriptedConnection(ScriptedDevice& scripted) : device_(scripted) {
      if (device_.gone || device_.reports_lost) throw InputError(device_.can.name, "cannot be had");
      ++device_.opened;
    }
    ~ScriptedConnection() override { ++device_.closed; }
    const DeviceCapabilities& capabilities() const override { return device_.can; }
    ConnectionStatus read(DeviceInput& heard) override {
      if (device_.throws) throw std::runtime_error("the cable came off");
      if (device_.gone || device_.reports_lost) return ConnectionStatus::lost;
      if (device_.silent) return ConnectionStatus::silent;
      heard = device_.input;
      return ConnectionStatus::fresh;
    }
    ConnectionStatus write(const Wrench& wrench_B) override {
      if (device_.gone) return ConnectionStatus::lost;
      if (device_.busy) return ConnectionStatus::silent;
      device_.got.push_back({device_.now_s, wrench_B});
      return ConnectionStatus::fresh;
    }

   private:
    ScriptedDevice& device_;
  };
};

}  // namespace osteomill::testing_support
