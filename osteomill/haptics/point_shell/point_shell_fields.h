#pragma once

#include <span>

#include "osteomill/haptics/point_shell/point_shell_settings.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill {

/// The names under which recordings list and configurations set each member of PointShellSettings.
std::span<const SettingField<PointShellSettings>> point_shell_fields();

}  // namespace osteomill
