#pragma once

#include <cstdint>
#include <vector>

#include <hwy/targets.h>

namespace osteomill::testing_support {

/// Returns the vector instruction sets that this processor supports and a kernel was compiled for.
inline std::vector<std::int64_t> available_instruction_sets(std::int64_t compiled) {
  std::vector<std::int64_t> sets;
  const std::int64_t both = hwy::SupportedTargets() & compiled;
  for (int place = 0; place < 63; ++place) {
    const std::int64_t bit = std::int64_t{1} << place;
    if ((both & bit) != 0) sets.push_back(bit);
  }
  return sets;
}

/// Makes kernels use one instruction set during its lifetime.
struct ForcedInstructionSet {
  explicit ForcedInstructionSet(std::int64_t set) { hwy::SetSupportedTargetsForTest(set); }
  ~ForcedInstructionSet() { hwy::SetSupportedTargetsForTest(0); }
  ForcedInstructionSet(const ForcedInstructionSet&) = delete;
  ForcedInstructionSet& operator=(const ForcedInstructionSet&) = delete;
};

}  // namespace osteomill::testing_support
