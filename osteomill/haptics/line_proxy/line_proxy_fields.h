#pragma once

#include <span>

#include "osteomill/haptics/line_proxy/line_proxy_settings.h"
#include "osteomill/haptics/setting_fields.h"

namespace osteomill {

/// The names under which recordings list and configurations set each member of LineProxySettings.
std::span<const SettingField<LineProxySettings>> line_proxy_fields();

}  // namespace osteomill
