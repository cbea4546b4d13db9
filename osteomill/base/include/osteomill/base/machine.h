#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace osteomill {

/// Returns the number of threads this program may run in parallel: the processors in its affinity mask
/// (sched_getaffinity), or fewer if its control groups (cgroup v2, cpu.max) limit its CPU time; at least 1.
/// `root` is the folder that contains proc/self/cgroup and sys/fs/cgroup.
std::size_t allowed_threads(const std::filesystem::path& root = "/");

/// Returns the memory this program may use, bytes: the machine's physical memory, or less if its control
/// groups (cgroup v2, memory.max) limit it.
std::uint64_t allowed_memory_bytes(const std::filesystem::path& root = "/");

}  // namespace osteomill
