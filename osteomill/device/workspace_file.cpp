#include "osteomill/device/workspace_file.h"

#include <cctype>
#include <ostream>
#include <stdexcept>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"
#include "osteomill/files/user_folders.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestName = 100;

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
  std::string name = device_name.substr(0, kLongestName);
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

void keep_workspace(const fs::path& path, const std::string& device_name, const WorkspaceSettings& settings) {
  create_folder(path.parent_path());
  write_text_atomically(path, [&](std::ostream& text) {
    const Vec3& turn = settings.turn_V_deg;
    text << fmt::format(
        "# How {} moves the tool in osteomill (docs/devices.md).\n"
        "scale = {}\npower = {}\nturn_deg = [{}, {}, {}]\nshaft_lever_mm = {}\n",
        device_name, settings.scale, settings.power, turn.x(), turn.y(), turn.z(), settings.shaft_lever_mm);
  });
}

}  // namespace osteomill
