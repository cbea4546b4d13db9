// Replaces the desktop's portal on the session bus: answers file requests with the given answers in turn, and
// logs the requests to the file ASKED:
//   portal_stand_in ASKED ANSWER...
// An answer is a URI, "cancel", or "refuse" for an error.
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <sdbus-c++/sdbus-c++.h>

int main(int argc, char** argv) {
  using Options = std::map<std::string, sdbus::Variant>;
  constexpr const char* kRequest = "org.freedesktop.portal.Request";
  const std::string asked = argv[1];
  std::vector<std::string> answers(argv + 2, argv + argc);
  const auto connection = sdbus::createSessionBusConnection("org.freedesktop.portal.Desktop");
  const auto object = sdbus::createObject(*connection, "/org/freedesktop/portal/desktop");
  std::vector<std::unique_ptr<sdbus::IObject>> requests;
  object->registerMethod("OpenFile")
      .onInterface("org.freedesktop.portal.FileChooser")
      .implementedAs([&](const std::string&, const std::string&, const Options& options) {
        const auto folder = options.at("current_folder").get<std::vector<std::uint8_t>>();
        std::ofstream(asked, std::ios::app) << (options.at("directory").get<bool>() ? "folder " : "file ")
                                            << std::string(folder.begin(), folder.end() - 1) << '\n';
        const std::string answer = answers.empty() ? "refuse" : answers.front();
        if (!answers.empty()) answers.erase(answers.begin());
        if (answer == "refuse") throw sdbus::Error("org.freedesktop.portal.Error.Failed", "refused");
        std::string sender = object->getCurrentlyProcessedMessage()->getSender().substr(1);
        std::replace(sender.begin(), sender.end(), '.', '_');
        const std::string path = "/org/freedesktop/portal/desktop/request/" + sender + "/" +
                                 options.at("handle_token").get<std::string>();
        auto& request = requests.emplace_back(sdbus::createObject(*connection, path));
        request->registerSignal("Response").onInterface(kRequest).withParameters<std::uint32_t, Options>();
        request->finishRegistration();
        Options results;
        if (answer != "cancel") results["uris"] = std::vector<std::string>{answer};
        request->emitSignal("Response")
            .onInterface(kRequest)
            .withArguments(std::uint32_t{answer == "cancel" ? 1u : 0u}, results);
        return sdbus::ObjectPath(path);
      });
  object->finishRegistration();
  connection->enterEventLoop();
}
