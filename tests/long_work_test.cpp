// Opening a scan reports progress evenly enough, and can be cancelled at any moment.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "osteomill/base/work_progress.h"
#include "osteomill/ct/read_scan.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/live/live_milling.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 160;

class LongWork : public ::testing::TestWithParam<std::string> {
 protected:
  LongWork() {
    std::ofstream file(path_, std::ios::binary);
    file << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: " << kSide << ' ' << kSide << ' ' << kSide
         << "\nspacings: 0.2 0.2 0.2\nencoding: raw\n\n";
    // A block of bone with holes through it.
    for (int k = 0; k < kSide; ++k)
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i)
          file.put(k < 110 && (i % 40 > 12 || j % 40 > 12) ? static_cast<char>(200) : '\0');
  }
  ~LongWork() override { fs::remove(path_); }

  void open() const {
    std::shared_ptr<Volume> bone;
    {
      const WorkProgress::Part reading(0.5);
      bone = std::make_shared<Volume>(read_scan(path_).grid, 100.0);
    }
    const WorkProgress::Part preparing(1);
    MillingSetup setup;
    setup.algorithm = algorithm_named(GetParam());
    prepare_milling(bone, setup);
  }

  static long resident_kB() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
      long value = 0;
      if (word == "VmRSS:" && status >> value) return value;
    }
    return 0;
  }

 private:
  fs::path path_ =
      fs::temp_directory_path() / ("osteomill-long-work-" + std::to_string(::getpid()) + ".nrrd");
};

TEST_P(LongWork, ReportsProgressEvenly) {
  std::vector<double> reported{0};
  {
    const WorkProgress progress([&](double share) { reported.push_back(share); });
    open();
  }
  ASSERT_GT(reported.size(), 50u);
  for (std::size_t n = 1; n < reported.size(); ++n) {
    ASSERT_GE(reported[n], reported[n - 1]);
    EXPECT_LT(reported[n] - reported[n - 1], 0.1) << "after " << reported[n - 1];
  }
  EXPECT_GT(reported.back(), 0.75);
  EXPECT_LE(reported.back(), 1.0);
}

TEST_P(LongWork, FreesMemoryWhenCancelled) {
  open();
  const long before_kB = resident_kB();
  for (const double at : {0.0, 0.2, 0.4, 0.55, 0.6, 0.65, 0.7, 0.8}) {
    const WorkProgress progress([&](double share) {
      if (share >= at) throw WorkStopped();
    });
    EXPECT_THROW(open(), WorkStopped) << at;
  }
  // The densities of all eight runs would be 130 MB; the allocator keeps some memory for reuse.
  EXPECT_LT(resident_kB(), before_kB + 40'000);
}

INSTANTIATE_TEST_SUITE_P(EachAlgorithm, LongWork,
                         ::testing::Values("line-proxy", "surface-points", "point-shell", "barrier-shell"),
                         [](const auto& algorithm) {
                           std::string name = algorithm.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace osteomill
