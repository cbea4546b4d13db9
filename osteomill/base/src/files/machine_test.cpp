#include "osteomill/base/machine.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sched.h>

#include "osteomill/base/temporary_folder.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

class Machine : public ::testing::Test {
 protected:
  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((root() / file).parent_path());
    std::ofstream(root() / file) << text;
  }
  fs::path root() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

TEST_F(Machine, HasPlausibleLimitsWithoutControlGroups) {
  EXPECT_GE(allowed_threads(root()), 1u);
  EXPECT_GT(allowed_memory_bytes(root()), 100'000'000u);
  EXPECT_LE(allowed_threads(), allowed_threads(root()));
}

TEST_F(Machine, UsesTheLimitsOfTheNarrowestControlGroup) {
  write("proc/self/cgroup", "4:memory:/other\n0::/a/b\n");
  write("sys/fs/cgroup/a/b/memory.max", "max\n");
  write("sys/fs/cgroup/a/memory.max", "50000000\n");
  write("sys/fs/cgroup/memory.max", "60000000\n");
  write("sys/fs/cgroup/other/memory.max", "1\n");
  write("sys/fs/cgroup/a/b/cpu.max", "max 100000\n");
  write("sys/fs/cgroup/cpu.max", "50000 100000\n");
  EXPECT_EQ(allowed_memory_bytes(root()), 50'000'000u);
  EXPECT_EQ(allowed_threads(root()), 1u);
}

// In a container with its own cgroup namespace, or with the host's path.
TEST_F(Machine, FindsContainerLimitsAtTheRootGroup) {
  for (const char* group : {"0::/\n", "0::/docker/0123\n", "0::/../..\n"}) {
    write("proc/self/cgroup", group);
    write("sys/fs/cgroup/memory.max", "70000000\n");
    EXPECT_EQ(allowed_memory_bytes(root()), 70'000'000u) << group;
  }
}

TEST_F(Machine, AllowsOneThreadOnOneProcessor) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int first = 0;
  while (!CPU_ISSET(first, &before)) ++first;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(allowed_threads(), 1u);
  ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}

}  // namespace
}  // namespace osteomill
