#include "osteomill/base/signal_cleanup.h"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/temporary_folder.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

// Returns the exit status of a child that runs `before` and then receives the signal.
template <typename Do>
int status_of_child_ended_by(int signal, const Do& before) {
  const ::pid_t child = ::fork();
  if (child == 0) {
    install_signal_cleanup();
    before();
    ::raise(signal);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(SignalCleanup, RemovesTemporaryFilesOnSigterm) {
  // Not a TemporaryFolder, which the child would remove too.
  const fs::path folder = fs::path(::testing::TempDir()) / "signal_cleanup";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto write = [&] {
    ::setenv("TMPDIR", folder.c_str(), 1);
    const TemporaryFolder unpacked;
    fs::create_directories(unpacked / "inner");
    for (int n = 0; n < 200; ++n) std::ofstream(unpacked / "inner" / ("file-" + std::to_string(n))) << "text";
    write_folder_atomically(folder / "out", [&](const fs::path& beside) {
      std::ofstream(beside / "a.csv") << "half";
      write_text_atomically(folder / "b.csv", [](std::ostream& out) {
        out << "half" << std::flush;
        ::raise(SIGTERM);
      });
    });
  };
  const int status = status_of_child_ended_by(SIGTERM, write);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
  std::vector<fs::path> left;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) left.push_back(entry.path());
  EXPECT_EQ(left, std::vector{folder / "out"});
  fs::remove_all(folder);
}

TEST(SignalCleanup, KeepsAnIgnoredSignalIgnored) {
  const auto ignore = [] {
    std::signal(SIGHUP, SIG_IGN);
    install_signal_cleanup();
  };
  const int status = status_of_child_ended_by(SIGHUP, ignore);
  EXPECT_TRUE(WIFEXITED(status));
}

}  // namespace
}  // namespace osteomill
