#include "osteomill/files/user_folders.h"

#include <cstdlib>

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// A path that is not absolute does not count.
fs::path folder_named_by(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path folder = value != nullptr ? value : "";
  return folder.is_absolute() ? folder : fs::path();
}

fs::path own_folder(const char* variable, const char* in_home) {
  if (const fs::path named = folder_named_by(variable); !named.empty()) return named / "osteomill";
  if (const fs::path home = folder_named_by("HOME"); !home.empty()) return home / in_home / "osteomill";
  return {};
}

}  // namespace

fs::path state_folder() {
  return own_folder("XDG_STATE_HOME", ".local/state");
}

fs::path config_folder() {
  return own_folder("XDG_CONFIG_HOME", ".config");
}

}  // namespace osteomill
