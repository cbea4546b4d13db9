#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "osteomill/device/workspace.h"

namespace osteomill {

/// Where a device's workspace is kept, by the device's name: in `config_folder()`, under devices/; empty
/// where there is no such folder.
std::filesystem::path workspace_path(const std::string& device_name);

/// As it was kept; nothing where none was. Throws InputError naming the file where it is at fault.
std::optional<WorkspaceSettings> read_workspace(const std::filesystem::path& path);
/// Throws InputError where it cannot be written.
void keep_workspace(const std::filesystem::path& path, const std::string& device_name,
                    const WorkspaceSettings& settings);

}  // namespace osteomill
