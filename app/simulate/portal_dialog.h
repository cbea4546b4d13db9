#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace osteomill::app {

/// Result of the desktop's file dialog.
struct PortalAnswer {
  /// False if there is no such dialog: no session bus, no portal, or no response within seconds.
  bool is_available = false;
  /// The chosen file or folder; std::nullopt if the user cancelled.
  std::optional<std::string> path;
};

/// Lets the user choose a file or folder in the desktop's own dialog (org.freedesktop.portal.FileChooser on
/// the session bus). For one thread, which never waits longer than the bus takes to respond.
class PortalDialog {
 public:
  PortalDialog();
  ~PortalDialog();
  PortalDialog(const PortalDialog&) = delete;
  PortalDialog& operator=(const PortalDialog&) = delete;

  /// Shows the dialog, starting in `start` if the desktop supports that. Not while it is shown.
  void ask(bool for_folder, const std::filesystem::path& start);
  bool is_asking() const { return request_ != nullptr; }
  /// Stops waiting for the answer.
  void give_up();
  /// Returns the answer once it is there.
  std::optional<PortalAnswer> take_answer();

 private:
  struct Request;
  std::unique_ptr<Request> request_;
};

/// Returns the path of a file URI, percent-decoded; std::nullopt for any other URI.
std::optional<std::string> path_of_uri(const std::string& uri);

}  // namespace osteomill::app
