#pragma once

#include <span>

#include "osteomill/haptics/setting_fields.h"
#include "osteomill/haptics/surface_points/surface_points_settings.h"

namespace osteomill {

/// The names under which recordings list and configurations set each member of SurfacePointsSettings.
std::span<const SettingField<SurfacePointsSettings>> surface_points_fields();

}  // namespace osteomill
