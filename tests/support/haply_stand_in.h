#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <libwebsockets.h>
#include <nlohmann/json.hpp>

#include "tests/support/stand_in.h"

namespace osteomill::testing_support {

/// Replaces Haply's Inverse service: sends an inventory to each client that connects, then a state for each
/// text, as in docs.haply.co/inverseSDK/service/realtime/websocket-protocol (3.5), and `status` as in
/// docs.haply.co/inverseSDK/service/api/simulation.
class HaplyStandIn {
 public:
  explicit HaplyStandIn(int port = 0) {
    lws_set_log_level(0, nullptr);
    lws_context_creation_info info{};
    info.port = port;
    info.iface = "lo";
    info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS;
    info.user = this;
    context_ = lws_create_context(&info);
    info.protocols = protocols_.data();
    lws_vhost* const vhost = lws_create_vhost(context_, &info);
    port_ = vhost == nullptr ? 0 : lws_get_vhost_listen_port(vhost);
    thread_ = std::thread([this] {
      while (!ends_) lws_service(context_, 0);
    });
  }
  ~HaplyStandIn() {
    ends_ = true;
    lws_cancel_service(context_);
    thread_.join();
    lws_context_destroy(context_);
  }
  HaplyStandIn(const HaplyStandIn&) = delete;
  HaplyStandIn& operator=(const HaplyStandIn&) = delete;

  int port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  /// Set these before a client connects.
  std::atomic<bool> is_3_5{true};
  const char* grip = "wireless_verse_grip";
  std::atomic<bool> has_device{true};
  std::atomic<bool> has_minverse_first{false};
  std::atomic<const char*> type{"inverse3"};
  /// Status of the device and its grip, sent with every state.
  std::atomic<bool> is_calibrated{true};
  std::atomic<bool> is_awake{true};
  std::atomic<bool> is_in_use{false};
  /// Factor by which the service's filters scale a force.
  std::atomic<double> force_scale{1};

  /// Sends `text` from now on instead of states.
  void say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    instead_ = text;
  }
  /// Stops answering; or closes the connection at the next text.
  std::atomic<bool> is_mute{false};
  std::atomic<bool> closes{false};
  /// Delay before each answer.
  std::atomic<int> delay_ms{0};
  /// If false, the handle sweeps.
  std::atomic<bool> is_held{false};

  /// Returns the received texts.
  std::vector<std::string> heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  /// Returns the commanded force of each text.
  std::vector<std::array<double, 3>> forces() const {
    const std::lock_guard lock(mutex_);
    return forces_;
  }
  /// Returns the last commanded force, under the key of the service's version; NaN if the key was another.
  std::array<double, 3> force_N() const {
    const std::lock_guard lock(mutex_);
    return force_N_;
  }
  double max_N() const { return max_N_; }

  nlohmann::json state() const {
    const double x_m = is_held ? 0.01 : 1e-3 * swept_mm();
    nlohmann::json message;
    message["inverse3"] = nlohmann::json::array();
    if (has_minverse_first)
      message["inverse3"].push_back({{"device_id", "0001"}, {"config", {{"type", "minverse"}}}});
    if (has_device) {
      const double s = force_scale;
      const auto& [x, y, z] = force_N_;
      message["inverse3"].push_back({{"device_id", "049D"},
                                     {"state",
                                      {{"cursor_position", {{"x", x_m}, {"y", -0.02}, {"z", 0.03}}},
                                       {"cursor_velocity", {{"x", 0.1}, {"y", 0.2}, {"z", -0.3}}},
                                       {"current_cursor_force", {{"x", s * x}, {"y", s * y}, {"z", s * z}}}}},
                                     {"status",
                                      {{"calibrated", is_calibrated.load()},
                                       {"in_use", is_in_use.load()},
                                       {"power_supply", true},
                                       {"ready", true},
                                       {"started", true}}}});
    }
    if (grip != nullptr) {
      const double s = std::sqrt(0.5);
      nlohmann::json held{{"orientation", {{"x", 0}, {"y", 0}, {"z", s}, {"w", s}}}};
      if (std::string(grip) == "verse_grip") {
        held["button"] = true;
      } else {
        held["buttons"] = {{"a", true}, {"b", false}, {"c", true}};
      }
      message[grip] = nlohmann::json::array(
          {{{"device_id", "61548"}, {"state", held}, {"status", {{"awake", is_awake.load()}}}}});
    }
    return message;
  }

 private:
  // State of one client's connection, so that unread answers do not reach the next client.
  struct Talk {
    std::string coming;
    std::deque<std::string> going;
  };

  static int on_event(lws* socket, lws_callback_reasons reason, void*, void* data, size_t length) {
    auto* const self = static_cast<HaplyStandIn*>(lws_context_user(lws_get_context(socket)));
    switch (reason) {
      case LWS_CALLBACK_ESTABLISHED: {
        nlohmann::json inventory = self->state();
        if (self->has_device) inventory["inverse3"].back()["config"]["type"] = self->type.load();
        if (self->is_3_5) inventory["session_id"] = 7;
        self->talks_[socket].going.push_back(inventory.dump());
        lws_callback_on_writable(socket);
        return 0;
      }
      case LWS_CALLBACK_RECEIVE: {
        Talk& talk = self->talks_[socket];
        talk.coming.append(static_cast<const char*>(data), length);
        if (lws_is_final_fragment(socket) == 0 || lws_remaining_packet_payload(socket) != 0) return 0;
        self->hear(std::exchange(talk.coming, {}));
        if (self->closes) return -1;
        if (self->is_mute) return 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(self->delay_ms));
        talk.going.push_back(self->answer());
        lws_callback_on_writable(socket);
        return 0;
      }
      case LWS_CALLBACK_SERVER_WRITEABLE: {
        std::deque<std::string>& going = self->talks_[socket].going;
        if (going.empty()) return 0;
        const std::string text = going.front();
        going.pop_front();
        std::vector<unsigned char> packet(LWS_PRE + text.size());
        std::copy(text.begin(), text.end(), packet.begin() + LWS_PRE);
        lws_write(socket, packet.data() + LWS_PRE, text.size(), LWS_WRITE_TEXT);
        if (!going.empty()) lws_callback_on_writable(socket);
        return 0;
      }
      case LWS_CALLBACK_CLOSED: {
        self->talks_.erase(socket);
        const auto& [x, y, z] = self->force_N_;
        log_of_stand_in("closed, heard", self->heard_.size(), "most", self->max_N_.load(), "last", x, y, z);
        return 0;
      }
      default:
        return 0;
    }
  }

  std::string answer() const {
    const std::lock_guard lock(mutex_);
    return instead_.empty() ? state().dump() : instead_;
  }

  void hear(const std::string& text) {
    const std::lock_guard lock(mutex_);
    heard_.push_back(text);
    const char* const key = is_3_5 ? "vector" : "values";
    const auto message = nlohmann::json::parse(text, nullptr, false);
    const auto force = message.value(
        nlohmann::json::json_pointer(std::string("/inverse3/0/commands/set_cursor_force/") + key),
        nlohmann::json{{"x", NAN}, {"y", NAN}, {"z", NAN}});
    force_N_ = {force["x"], force["y"], force["z"]};
    forces_.push_back(force_N_);
    max_N_ = std::max(max_N_.load(), std::hypot(force_N_[0], force_N_[1], force_N_[2]));
  }

  const std::array<lws_protocols, 2> protocols_{
      {{"simulation", &on_event, 0, 64 * 1024, 0, nullptr, 0}, {nullptr, nullptr, 0, 0, 0, nullptr, 0}}};
  lws_context* context_ = nullptr;
  int port_ = 0;
  std::atomic<bool> ends_{false};
  std::map<lws*, Talk> talks_;
  mutable std::mutex mutex_;
  std::string instead_;
  std::vector<std::string> heard_;
  std::vector<std::array<double, 3>> forces_;
  std::array<double, 3> force_N_{};
  std::atomic<double> max_N_{0};
  std::thread thread_;
};

}  // namespace osteomill::testing_support
