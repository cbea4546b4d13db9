#include "osteomill/haptics/make_algorithm.h"

#include <stdexcept>

#include "osteomill/haptics/line_proxy/line_proxy.h"
#include "osteomill/haptics/line_proxy/line_proxy_fields.h"
#include "osteomill/haptics/point_shell/point_shell_algorithm.h"
#include "osteomill/haptics/point_shell/point_shell_fields.h"
#include "osteomill/haptics/surface_points/surface_points.h"
#include "osteomill/haptics/surface_points/surface_points_fields.h"

namespace osteomill {

namespace {

template <typename Settings>
void apply_named(Settings& settings, std::span<const SettingField<Settings>> fields, AlgorithmId algorithm,
                 const HapticSettings& user) {
  for (const HapticSettings::Named& named : user.named) {
    if (named.algorithm != algorithm) continue;
    try {
      set_setting(settings, fields, named.name, named.value);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string(name_of(algorithm)) + ": " + error.what());
    }
  }
}

LineProxySettings line_proxy_settings(const HapticSettings& user) {
  LineProxySettings settings = LineProxySettings::defaults(user.mode);
  if (user.stiffness_N_per_mm) settings.stiffness_N_per_mm = *user.stiffness_N_per_mm;
  if (user.vertices) settings.vertices = *user.vertices;
  apply_named(settings, line_proxy_fields(), AlgorithmId::line_proxy, user);
  return settings;
}

SurfacePointsSettings surface_points_settings(const HapticSettings& user) {
  SurfacePointsSettings settings = SurfacePointsSettings::defaults(user.mode);
  if (user.stiffness_N_per_mm) settings.stiffness_N_per_mm = *user.stiffness_N_per_mm;
  if (user.slices) settings.slices = *user.slices;
  apply_named(settings, surface_points_fields(), AlgorithmId::surface_points, user);
  return settings;
}

PointShellSettings point_shell_settings(const HapticSettings& user) {
  PointShellSettings settings = PointShellSettings::defaults(user.mode);
  if (user.stiffness_N_per_mm) settings.translational_stiffness_N_per_mm = *user.stiffness_N_per_mm;
  if (user.torsional_stiffness_Nmm_per_rad) {
    settings.torsional_stiffness_Nmm_per_rad = *user.torsional_stiffness_Nmm_per_rad;
  }
  if (user.shell_scale) settings.shell.scale = *user.shell_scale;
  apply_named(settings, point_shell_fields(), AlgorithmId::point_shell, user);
  return settings;
}

}  // namespace

std::unique_ptr<HapticAlgorithm> make_algorithm(AlgorithmId algorithm, const HapticSettings& settings) {
  switch (algorithm) {
    case AlgorithmId::line_proxy:
      return std::make_unique<LineProxy>(line_proxy_settings(settings));
    case AlgorithmId::surface_points:
      return std::make_unique<SurfacePoints>(surface_points_settings(settings));
    case AlgorithmId::point_shell:
      return std::make_unique<PointShellAlgorithm>(point_shell_settings(settings));
  }
  throw std::invalid_argument("no such algorithm");
}

std::vector<SettingValue> describe_algorithm(AlgorithmId algorithm, const HapticSettings& settings) {
  switch (algorithm) {
    case AlgorithmId::line_proxy:
      return describe_settings(line_proxy_settings(settings), line_proxy_fields());
    case AlgorithmId::surface_points:
      return describe_settings(surface_points_settings(settings), surface_points_fields());
    case AlgorithmId::point_shell:
      return describe_settings(point_shell_settings(settings), point_shell_fields());
  }
  throw std::invalid_argument("no such algorithm");
}

}  // namespace osteomill
