#include "app/simulate/first_time.h"

#include <cstdlib>
#include <ostream>
#include <system_error>

#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

// The freedesktop.org rules for base directories: a path that is not absolute does not count.
fs::path folder_named_by(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path folder = value != nullptr ? value : "";
  return folder.is_absolute() ? folder : fs::path();
}

}  // namespace

fs::path state_folder() {
  if (const fs::path state = folder_named_by("XDG_STATE_HOME"); !state.empty()) return state / "osteomill";
  if (const fs::path home = folder_named_by("HOME"); !home.empty()) return home / ".local/state/osteomill";
  return {};
}

bool first_time_of_help() {
  const fs::path folder = state_folder();
  if (folder.empty()) return true;
  const fs::path marker = folder / "help-seen";
  std::error_code unreadable;
  if (fs::exists(marker, unreadable)) return false;
  try {
    create_folder(folder);
    write_text_atomically(marker, [](std::ostream& text) {
      text << "The page of osteomill simulate that explains the controls was shown; F1 shows it again.\n";
    });
  } catch (const InputError&) {
    // Then it is shown again next time.
  }
  return true;
}

}  // namespace osteomill::app
