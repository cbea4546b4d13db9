#pragma once

#include <filesystem>

#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/run_description.h"

namespace osteomill {

/// The description as attributes of the file's root, and its further settings as attributes of the group
/// /settings, the unit of KEY in the attribute KEY.unit. Labels, where there are any, are three attributes of
/// the group /labels each, VALUE.name, VALUE.colour ("#rrggbb") and VALUE.no_go (0 or 1). Failures are
/// InputErrors that name the file; under Hdf5Lock. Throws std::invalid_argument for a key that is empty,
/// stands twice or ends in ".unit".
void write_description(const std::filesystem::path& path, hid_t file, const RunDescription& description);
/// One more setting, of a new key.
void add_setting(const std::filesystem::path& path, hid_t file, const RunSetting& setting);
RunDescription read_description(const std::filesystem::path& path, hid_t file);

}  // namespace osteomill
