#include "osteomill/session/space_mouse.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace osteomill {
namespace {

using namespace std::chrono_literals;

// Stands in for spacenavd with its first protocol: eight words per event. Does not answer requests for the
// newer protocol, like old daemons.
class Daemon {
 public:
  Daemon() : path_(::testing::TempDir() + "/osteomill_spnav_" + std::to_string(getpid())) {
    unlink(path_.c_str());
    listener_ = socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof(address.sun_path) - 1);
    bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
    listen(listener_, 1);
    setenv("SPNAV_SOCKET", path_.c_str(), 1);
  }
  ~Daemon() {
    if (client_ >= 0) close(client_);
    close(listener_);
    unlink(path_.c_str());
    unsetenv("SPNAV_SOCKET");
  }
  void take_client() { client_ = accept(listener_, nullptr, nullptr); }
  void send(const std::array<std::int32_t, 8>& event) {
    EXPECT_EQ(write(client_, event.data(), sizeof(event)), static_cast<ssize_t>(sizeof(event)));
  }

 private:
  std::string path_;
  int listener_ = -1;
  int client_ = -1;
};

TEST(SpaceMouse, ReadsPushTwistAndButtonPresses) {
  Daemon daemon;
  SpaceMouse mouse;
  ASSERT_TRUE(mouse.is_present());
  daemon.take_client();
  EXPECT_EQ(mouse.read().push, Vec3::Zero());
  daemon.send({0, 175, -350, 70, 35, 0, -700, 16});
  daemon.send({1, 0, 0, 0, 0, 0, 0, 0});
  daemon.send({2, 0, 0, 0, 0, 0, 0, 0});
  std::this_thread::sleep_for(20ms);
  const SpaceMouseState state = mouse.read();
  EXPECT_NEAR((state.push - Vec3(0.5, -1, -0.2)).norm(), 0, 1e-12);
  EXPECT_NEAR((state.twist - Vec3(0.1, 0, 1)).norm(), 0, 1e-12);
  EXPECT_EQ(state.presses, 1);
  // Held still, the device sends no events but remains deflected.
  EXPECT_NEAR(mouse.read().push.x(), 0.5, 1e-12);
  EXPECT_EQ(mouse.read().presses, 0);
}

TEST(SpaceMouse, IsNotPresentWithoutADaemon) {
  setenv("SPNAV_SOCKET", "/nowhere/at/all", 1);
  SpaceMouse mouse;
  EXPECT_FALSE(mouse.is_present());
  EXPECT_EQ(mouse.read().push, Vec3::Zero());
  unsetenv("SPNAV_SOCKET");
}

}  // namespace
}  // namespace osteomill
