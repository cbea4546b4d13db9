#include <cstdlib>

#include <gtest/gtest.h>

#include "osteomill/report/report_samples.h"
#include "osteomill/report/write_report.h"

namespace osteomill {
namespace {
TEST(Figures, Draw) {
  write_report(testing_support::sample_runs(), "/tmp/recfig");
}
}  // namespace
}  // namespace osteomill
