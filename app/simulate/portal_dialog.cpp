#include "app/simulate/portal_dialog.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include <fmt/core.h>
#include <sdbus-c++/sdbus-c++.h>

namespace osteomill::app {

namespace {

constexpr const char* kPortal = "org.freedesktop.portal.Desktop";
constexpr const char* kPortalPath = "/org/freedesktop/portal/desktop";
// The bus may have to start the portal first. One that takes longer is probably broken, and our own dialog is
// better.
constexpr std::chrono::seconds kPatience(5);

using Options = std::map<std::string, sdbus::Variant>;

PortalAnswer answer_of(std::uint32_t code, const Options& results) {
  if (const auto uris = results.find("uris"); code == 0 && uris != results.end()) {
    const auto chosen = uris->second.get<std::vector<std::string>>();
    if (!chosen.empty()) return {true, path_of_uri(chosen.front())};
  }
  return {true, std::nullopt};
}

}  // namespace

struct PortalDialog::Request {
  // Set by the connection's thread.
  struct Answer {
    std::mutex mutex;
    std::optional<PortalAnswer> value;
    void set(const PortalAnswer& to) {
      const std::lock_guard lock(mutex);
      if (!value) value = to;
    }
  };

  void begin(bool for_folder, const std::filesystem::path& start);

  std::shared_ptr<Answer> answer = std::make_shared<Answer>();
  std::unique_ptr<sdbus::IConnection> connection;
  std::unique_ptr<sdbus::IProxy> response;
  std::unique_ptr<sdbus::IProxy> chooser;
};

void PortalDialog::Request::begin(bool for_folder, const std::filesystem::path& start) {
  connection = sdbus::createSessionBusConnection();
  // The portal answers with a signal from an object whose name is derived from our bus name and the token;
  // the signal may arrive before the call returns.
  std::string sender = connection->getUniqueName().substr(1);
  std::ranges::replace(sender, '.', '_');
  response =
      sdbus::createProxy(*connection, kPortal, fmt::format("{}/request/{}/osteomill", kPortalPath, sender));
  response->uponSignal("Response")
      .onInterface("org.freedesktop.portal.Request")
      .call([to = answer](const std::uint32_t& code, const Options& results) {
        try {
          to->set(answer_of(code, results));
        } catch (const sdbus::Error&) {
          to->set({});
        }
      });
  response->finishRegistration();
  chooser = sdbus::createProxy(*connection, kPortal, kPortalPath);
  chooser->finishRegistration();
  connection->enterEventLoopAsync();
  const std::string folder = start.string();
  std::vector<std::uint8_t> folder_bytes(folder.begin(), folder.end());
  folder_bytes.push_back(0);
  const Options options{{"handle_token", std::string("osteomill")},
                        {"directory", for_folder},
                        {"current_folder", folder_bytes}};
  chooser->callMethodAsync("OpenFile")
      .onInterface("org.freedesktop.portal.FileChooser")
      .withTimeout(kPatience)
      .withArguments(std::string(), std::string(for_folder ? "Open a folder" : "Open a scan"), options)
      .uponReplyInvoke([to = answer](const sdbus::Error* error, const sdbus::ObjectPath&) {
        if (error != nullptr) to->set({});
      });
}

PortalDialog::PortalDialog() = default;
PortalDialog::~PortalDialog() = default;

void PortalDialog::ask(bool for_folder, const std::filesystem::path& start) {
  request_ = std::make_unique<Request>();
  try {
    request_->begin(for_folder, start);
  } catch (const sdbus::Error&) {
    request_->answer->set({});
  }
}

void PortalDialog::give_up() {
  request_.reset();
}

std::optional<PortalAnswer> PortalDialog::take_answer() {
  if (!request_) return std::nullopt;
  std::optional<PortalAnswer> answer;
  {
    const std::lock_guard lock(request_->answer->mutex);
    answer = request_->answer->value;
  }
  if (answer) request_.reset();
  return answer;
}

std::optional<std::string> path_of_uri(const std::string& uri) {
  constexpr std::string_view kScheme = "file://";
  if (!uri.starts_with(kScheme)) return std::nullopt;
  std::string path;
  for (std::size_t n = kScheme.size(); n < uri.size(); ++n) {
    unsigned value = 0;
    const char* const digits = uri.data() + n + 1;
    if (uri[n] == '%' && n + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      path += static_cast<char>(value);
      n += 2;
    } else {
      path += uri[n];
    }
  }
  return path;
}

}  // namespace osteomill::app
