#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace osteomill::app {

/// The answer of the desktop's dialog for files.
struct PortalAnswer {
  /// False if there is no such dialog: no session bus, no portal on it, or none that answers within seconds.
  bool is_available = false;
  /// The file or folder that was chosen; nothing if the user cancelled.
  std::optional<std::string> path;
};

/// Asks for a file or folder by the desktop's own dialog (org.freedesktop.portal.FileChooser on the session
/// bus). For one thread, which never waits longer than the bus itself takes to answer.
class PortalDialog {
 public:
  PortalDialog();
  ~PortalDialog();
  PortalDialog(const PortalDialog&) = delete;
  PortalDialog& operator=(const PortalDialog&) = delete;

  /// Shows the dialog, in `start` if the desktop follows. Not while it is shown.
  void ask(bool for_folder, const std::filesystem::path& start);
  bool is_asking() const { return request_ != nullptr; }
  /// Waits for no answer any longer.
  void give_up();
  /// Returns the answer once it is there.
  std::optional<PortalAnswer> take_answer();

 private:
  struct Request;
  std::unique_ptr<Request> request_;
};

/// Returns the path that a file's URI names, with its %XX resolved; nothing for another kind of URI.
std::optional<std::string> path_of_uri(const std::string& uri);

}  // namespace osteomill::app
