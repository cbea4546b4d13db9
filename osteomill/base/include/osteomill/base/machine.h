#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace osteomill {

/// Returns how many threads this program may run at once: one for each processor that it is allowed
/// (sched_getaffinity), or fewer if its control groups (cgroup v2, cpu.max) give it less time; at least 1.
/// `root` is the folder that has proc/self/cgroup and sys/fs/cgroup in it.
std::size_t allowed_threads(const std::filesystem::path& root = "/");

/// Returns how many bytes of memory this program may take: what the machine has, or less if its control
/// groups (cgroup v2, memory.max) give it less.
std::uint64_t allowed_memory_bytes(const std::filesystem::path& root = "/");

}  // namespace osteomill
