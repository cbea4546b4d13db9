#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <thread>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "osteomill/base/input_error.h"
#include "osteomill/base/socket.h"
#include "osteomill/session/hardware.h"

#include "device/haply/web_socket.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr const char* kDefaultAddress = "127.0.0.1:10001";
// The service uses m.
constexpr double kMmPerM = 1000;
// The first message lists every device with its settings; later ones are a few kB.
constexpr std::size_t kMaxBytes = 1 << 18;
constexpr auto kInventoryWithin = 100ms;
constexpr auto kWait = 1500us;
constexpr auto kPollInterval = 500us;
// Time without an answer after which the connection counts as lost and is reopened.
constexpr auto kAnswersWithin = 1s;
// Latency limit, applied to a running mean over about kLatencies answers: ConnectedDevice ignores older
// poses.
constexpr double kMaxLatency_ms = 5;
constexpr double kLatencies = 20;
// Time constant, in answers, of the mean that detects forces other than those sent.
constexpr double kAnswers = 200;
constexpr double kOtherForce_N = 0.3;
constexpr double kOtherShare = 0.25;
constexpr const char* kOtherForces =
    "gives other forces than requested: check its filters and force scale in the Haply Hub";
constexpr const char* kGrips[] = {"wireless_verse_grip", "verse_grip"};

// Returns a member; null if the key is missing or has another type than expected. Never throws.
const Json* member(const Json* of, const char* key) {
  if (of == nullptr || !of->is_object()) return nullptr;
  const auto found = of->find(key);
  return found == of->end() ? nullptr : &*found;
}

// Returns the first element of the list `key` that matches the predicate, or null.
template <typename IsWanted>
const Json* first_of(const Json& of, const char* key, IsWanted is_wanted) {
  const Json* const list = member(&of, key);
  if (list == nullptr || !list->is_array()) return nullptr;
  const auto found = std::find_if(list->begin(), list->end(), is_wanted);
  return found == list->end() ? nullptr : &*found;
}

bool take(const Json* numbers, const char* key, double& value) {
  const Json* const number = member(numbers, key);
  if (number == nullptr || !number->is_number()) return false;
  value = number->get<double>();
  return true;
}

bool take(const Json* numbers, Vec3& vector) {
  return take(numbers, "x", vector.x()) && take(numbers, "y", vector.y()) && take(numbers, "z", vector.z());
}

bool is_true(const Json* value) {
  return value != nullptr && *value == true;
}

bool is_false(const Json* value) {
  return value != nullptr && *value == false;
}

// The list also contains Minverse devices, which must not get the forces of an Inverse3.
bool is_inverse3(const Json& device) {
  const Json* const type = member(member(&device, "config"), "type");
  const Json* const id = member(&device, "device_id");
  return id != nullptr && id->is_string() && (type == nullptr || *type == "inverse3" || *type == "inverse3x");
}

// Returns why the device may not be driven, or null. Without a status it counts as not calibrated.
const char* why_not_driven(const Json* status) {
  if (is_false(member(status, "power_supply"))) return "has no power: plug its power supply in";
  if (is_false(member(status, "ready")) || is_false(member(status, "started")))
    return "is not ready: check it in the Haply Hub";
  if (!is_true(member(status, "calibrated")))
    return "is not calibrated: calibrate it as its vendor says (inkwell)";
  return nullptr;
}

const char* why_grip_is_not_used(const Json* grip) {
  const Json* const status = member(grip, "status");
  for (const char* needed : {"awake", "connected", "ready"})
    if (is_false(member(status, needed))) return "has a grip that sleeps: press one of its buttons";
  return nullptr;
}

const Json* grip_of(const Json& message) {
  for (const char* kind : kGrips) {
    if (const Json* const grip = first_of(message, kind, [](const Json&) { return true; })) return grip;
  }
  return nullptr;
}

bool take_grip(const Json* grip, DeviceInput& input) {
  const Json* const state = member(grip, "state");
  const Json* const orientation = member(state, "orientation");
  Vec3 xyz;
  double w = 0;
  if (!take(orientation, xyz) || !take(orientation, "w", w)) return false;
  const Quat R_BH(w, xyz.x(), xyz.y(), xyz.z());
  if (R_BH.norm() < 0.5) return false;
  input.X_BH.orientation = R_BH.normalized();
  // A wired grip has one button, a wireless one three.
  const Json* const buttons = member(state, "buttons");
  input.buttons = is_true(member(state, "button")) || is_true(member(buttons, "a")) ? 1 : 0;
  input.buttons |= is_true(member(buttons, "b")) ? 2u : 0u;
  input.buttons |= is_true(member(buttons, "c")) ? 4u : 0u;
  return true;
}

// A connected service that has sent its inventory; no command has been sent to it.
struct OpenedService {
  explicit OpenedService(const HostAndPort& at) : socket(name_of(at), at.host, at.port, kMaxBytes) {
    const auto text = socket.receive(kInventoryWithin);
    if (!text) throw InputError(name_of(at), "the service sends no list of its devices");
    inventory = Json::parse(*text, nullptr, false);
    inverse3 = first_of(inventory, "inverse3", &is_inverse3);
    if (inverse3 == nullptr) throw InputError(name_of(at), "the service has no Inverse3");
  }

  static std::string name_of(const HostAndPort& at) { return fmt::format("haply:{}:{}", at.host, at.port); }
  bool is_in_use() const { return is_true(member(member(inverse3, "status"), "in_use")); }
  std::string id() const { return member(inverse3, "device_id")->get<std::string>(); }
  std::string name() const { return "Haply Inverse3 " + id(); }

  WebSocket socket;
  Json inventory;
  const Json* inverse3;
};

class HaplyConnection final : public Connection {
 public:
  explicit HaplyConnection(const HostAndPort& at)
      : service_(at),
        id_(service_.id()),
        // Version 3.5 sends a session id and takes the force as `vector`; earlier versions as `values`.
        force_key_(service_.inventory.contains("session_id") ? "vector" : "values"),
        has_grip_(grip_of(service_.inventory) != nullptr) {
    if (service_.is_in_use())
      throw InputError(OpenedService::name_of(at), "another program has the Inverse3 " + id_ + " in use");
    capabilities_.name = service_.name();
    capabilities_.sensed = has_grip_ ? 6 : 3;
    capabilities_.driven = 3;
    capabilities_.R_VB = Mat3{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    capabilities_.limits = {10, 0};
    not_driven_ = why_not_driven(member(service_.inverse3, "status"));
    // Identifies this program in the Haply Hub; sent once.
    send_force(Vec3::Zero(), {{"session", {{"configure", {{"profile", {{"name", "osteomill"}}}}}}}});
  }
  ~HaplyConnection() override { send_force(Vec3::Zero()); }

  const DeviceCapabilities& capabilities() const override { return capabilities_; }

  ConnectionStatus read(DeviceInput& input) override {
    const auto text = service_.socket.receive(kWait);
    if (!text) {
      if (is_answer_pending_ && Clock::now() - request_time_ > kAnswersWithin) return ConnectionStatus::lost;
      return or_lost(ConnectionStatus::silent);
    }
    if (is_answer_pending_) check_latency();
    is_answer_pending_ = false;
    // Limits the rate of requests to a service that answers immediately.
    std::this_thread::sleep_until(next_);
    next_ = Clock::now() + kPollInterval;
    return take_state(*text, input) ? ConnectionStatus::fresh : ConnectionStatus::silent;
  }

  ConnectionStatus write(const Wrench& wrench_B) override {
    // Only one message may be pending; otherwise a slow service would apply outdated wrenches.
    if (is_answer_pending_) return or_lost(ConnectionStatus::silent);
    return or_lost(send_force(wrench_B.force_N) ? ConnectionStatus::fresh : ConnectionStatus::silent);
  }

 private:
  ConnectionStatus or_lost(ConnectionStatus status) const {
    return service_.socket.is_open() ? status : ConnectionStatus::lost;
  }

  // Sends the force; the service answers with the state of all devices. Returns false if the message is still
  // pending.
  bool send_force(const Vec3& force_N, Json message = Json::object()) {
    const Json force{{force_key_, {{"x", force_N.x()}, {"y", force_N.y()}, {"z", force_N.z()}}}};
    const Json device{{"device_id", id_}, {"commands", {{"set_cursor_force", force}}}};
    message["inverse3"] = Json::array({device});
    force_N_ = force_N;
    is_answer_pending_ = true;
    request_time_ = Clock::now();
    return service_.socket.send(message.dump());
  }

  // Keeps one message while the service is slow, because `remark` points to it.
  void check_latency() {
    const double latency_ms = std::chrono::duration<double, std::milli>(Clock::now() - request_time_).count();
    mean_latency_ms_ += (latency_ms - mean_latency_ms_) / kLatencies;
    if (mean_latency_ms_ <= kMaxLatency_ms) {
      slow_remark_[0] = '\0';
    } else if (slow_remark_[0] == '\0') {
      *fmt::format_to_n(slow_remark_.data(), slow_remark_.size() - 1,
                        "answers after {:.0f} ms; above {:g} ms almost nothing can be felt", latency_ms,
                        kMaxLatency_ms)
           .out = '\0';
    }
  }

  // The service's filters and force scale may change the forces.
  bool gives_other_forces(const Json* state) {
    Vec3 given_N;
    if (!take(member(state, "current_cursor_force"), given_N)) return false;
    mean_asked_N_ += (force_N_.norm() - mean_asked_N_) / kAnswers;
    mean_other_N_ += ((given_N - force_N_).norm() - mean_other_N_) / kAnswers;
    return mean_other_N_ > kOtherForce_N && mean_other_N_ > kOtherShare * mean_asked_N_;
  }

  bool take_state(const std::string& text, DeviceInput& input) {
    const Json message = Json::parse(text, nullptr, false);
    const Json* const device = first_of(message, "inverse3", [&](const Json& one) {
      const Json* const id = member(&one, "device_id");
      return id != nullptr && *id == id_;
    });
    const Json* const state = member(device, "state");
    DeviceInput now;
    const Json* const grip = grip_of(message);
    if (!take(member(state, "cursor_position"), now.X_BH.position_mm) || (has_grip_ && !take_grip(grip, now)))
      return false;
    now.X_BH.position_mm *= kMmPerM;
    if (const Json* const status = member(device, "status")) not_driven_ = why_not_driven(status);
    now.not_driven = not_driven_ != nullptr ? not_driven_ : why_grip_is_not_used(grip);
    if (gives_other_forces(state)) now.remark = kOtherForces;
    if (slow_remark_[0] != '\0') now.remark = slow_remark_.data();
    input = now;
    return true;
  }

  OpenedService service_;
  std::string id_;
  std::string force_key_;
  bool has_grip_;
  DeviceCapabilities capabilities_;
  // Last known reason; messages without a status keep it.
  const char* not_driven_ = nullptr;
  Vec3 force_N_ = Vec3::Zero();
  double mean_asked_N_ = 0;
  double mean_other_N_ = 0;
  double mean_latency_ms_ = 0;
  std::array<char, 120> slow_remark_{};
  bool is_answer_pending_ = false;
  Clock::time_point request_time_;
  Clock::time_point next_ = Clock::now();
};

HostAndPort place_of(const std::string& address) {
  return resolve_address("haply", address.empty() ? kDefaultAddress : address);
}

}  // namespace

std::unique_ptr<Connection> open_haply(const std::string& address) {
  return std::make_unique<HaplyConnection>(place_of(address));
}

std::string probe_haply(const std::string& address) {
  const OpenedService service(place_of(address));
  return service.name() + (service.is_in_use() ? ", in use by another program" : "");
}

}  // namespace osteomill
