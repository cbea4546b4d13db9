#include "osteomill/session/workspace.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <ostream>
#include <stdexcept>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/positive.h"

namespace osteomill {

void require_valid(const WorkspaceSettings& settings) {
  require_positive(settings.scale, "the device's scale");
  require_positive(settings.power, "the device's power");
  if (!settings.turn_V_deg.allFinite()) throw std::invalid_argument("the device's turn must be finite");
  require_not_negative(settings.shaft_lever_mm, "the shaft's lever");
}

std::optional<Vec3> turn_by_moves_deg(const DeviceCapabilities& device, const Vec3& right_B_mm,
                                      const Vec3& up_B_mm) {
  constexpr double kShortest_mm = 10;
  constexpr double kMaxCosine = 0.5;
  if (!(right_B_mm.norm() >= kShortest_mm && up_B_mm.norm() >= kShortest_mm)) return std::nullopt;
  const Vec3 right = right_B_mm.normalized();
  const Vec3 up = up_B_mm.normalized();
  if (std::abs(right.dot(up)) > kMaxCosine) return std::nullopt;
  Mat3 R_BV;
  R_BV.col(0) = right;
  R_BV.col(2) = right.cross(up).normalized();
  R_BV.col(1) = R_BV.col(2).cross(R_BV.col(0));
  const Quat R_VB(Mat3(R_BV.transpose()));
  return 180 / std::numbers::pi * rotation_vector((R_VB * device.R_VB.conjugate()).normalized());
}

Quat view_from_the_front() {
  // The viewer's right is x of W (the patient's left), up is z.
  return quaternion_from_rotation_vector(0.5 * std::numbers::pi * Vec3::UnitX());
}

Workspace::Workspace(const DeviceCapabilities& device, const WorkspaceSettings& settings)
    : drives_torque_(device.driven == 6), device_limits_(device.limits), R_VB_as_made_(device.R_VB) {
  require_valid(settings);
  set(settings, view_from_the_front());
}

void Workspace::set(const WorkspaceSettings& settings, const Quat& R_WV) {
  settings_ = settings;
  const Vec3 turn_rad = std::numbers::pi / 180 * settings.turn_V_deg;
  R_WB_ = (R_WV * quaternion_from_rotation_vector(turn_rad) * R_VB_as_made_).normalized();
}

void Workspace::anchor(const Pose& X_WT, const Pose& X_BH) noexcept {
  anchor_X_WT_ = X_WT;
  anchor_X_BH_ = X_BH;
}

Pose Workspace::tool_pose(const Pose& X_BH) const noexcept {
  const Vec3 moved_B_mm = X_BH.position_mm - anchor_X_BH_.position_mm;
  const Quat turned_B = X_BH.orientation * anchor_X_BH_.orientation.conjugate();
  const Quat turned_W = R_WB_ * turned_B * R_WB_.conjugate();
  return {anchor_X_WT_.position_mm + settings_.scale * (R_WB_ * moved_B_mm),
          (turned_W * anchor_X_WT_.orientation).normalized()};
}

Wrench Workspace::wrench_B(const Wrench& wrench_W, const Vec3& shaft_W) const noexcept {
  const Quat R_BW = R_WB_.conjugate();
  Vec3 force_W_N = wrench_W.force_N;
  // Force at the burr whose moment about the hand equals the torque.
  if (!drives_torque_ && settings_.shaft_lever_mm > 0)
    force_W_N += shaft_W.cross(wrench_W.torque_Nmm) / settings_.shaft_lever_mm;
  return {settings_.power * settings_.scale * (R_BW * force_W_N),
          drives_torque_ ? Vec3(settings_.power * (R_BW * wrench_W.torque_Nmm)) : Vec3::Zero()};
}

WrenchLimits Workspace::limits_W(const WrenchLimits& limits) const {
  const double torque_Nmm = drives_torque_ ? device_limits_.torque_Nmm / settings_.power : limits.torque_Nmm;
  return {std::min(limits.force_N, device_limits_.force_N / (settings_.power * settings_.scale)),
          std::min(limits.torque_Nmm, torque_Nmm)};
}

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxNameLength = 100;

double number_of(const toml::node& value, const std::string& key, const fs::path& path) {
  const auto number = value.value<double>();
  if (!number) throw InputError(path.string(), key + " is not a number");
  return *number;
}

Vec3 vector_of(const toml::node& value, const std::string& key, const fs::path& path) {
  const toml::array* list = value.as_array();
  if (list == nullptr || list->size() != 3) throw InputError(path.string(), key + " is not three numbers");
  Vec3 vector;
  for (Eigen::Index n = 0; n < 3; ++n) vector[n] = number_of((*list)[static_cast<std::size_t>(n)], key, path);
  return vector;
}

void take(WorkspaceSettings& settings, const std::string& key, const toml::node& value,
          const fs::path& path) {
  if (key == "scale") {
    settings.scale = number_of(value, key, path);
  } else if (key == "power") {
    settings.power = number_of(value, key, path);
  } else if (key == "turn_deg") {
    settings.turn_V_deg = vector_of(value, key, path);
  } else if (key == "shaft_lever_mm") {
    settings.shaft_lever_mm = number_of(value, key, path);
  } else {
    throw InputError(path.string(), "has no key " + key);
  }
}

}  // namespace

fs::path workspace_path(const std::string& device_name) {
  const fs::path folder = config_folder();
  if (folder.empty()) return {};
  std::string name = device_name.substr(0, kMaxNameLength);
  for (char& letter : name) {
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '-';
  }
  return folder / "devices" / (name + ".toml");
}

std::optional<WorkspaceSettings> read_workspace(const fs::path& path) {
  if (path.empty() || !fs::exists(path)) return std::nullopt;
  try {
    WorkspaceSettings settings;
    for (auto&& [key, value] : toml::parse_file(path.string()))
      take(settings, std::string(key.str()), value, path);
    require_valid(settings);
    return settings;
  } catch (const toml::parse_error& error) {
    throw InputError(path.string(),
                     fmt::format("line {}: {}", error.source().begin.line, error.description()));
  } catch (const std::invalid_argument& error) {
    throw InputError(path.string(), error.what());
  }
}

void save_workspace(const fs::path& path, const WorkspaceSettings& settings) {
  create_folder(path.parent_path());
  write_text_atomically(path, [&](std::ostream& text) {
    const Vec3& turn = settings.turn_V_deg;
    text << fmt::format(
        "# How the device of this name moves the tool in osteomill (docs/devices.md).\n"
        "scale = {}\npower = {}\nturn_deg = [{}, {}, {}]\nshaft_lever_mm = {}\n",
        settings.scale, settings.power, turn.x(), turn.y(), turn.z(), settings.shaft_lever_mm);
  });
}

}  // namespace osteomill
