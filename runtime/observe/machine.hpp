#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace lancet::runtime {

/// Model name of the first processor ("model name" of /proc/cpuinfo), or "unknown" and the architecture.
std::string cpu_model();

/// Processors that are online.
int cores_online();

/// Processors that this process may run on.
int cores_allowed();

/// Name, release and machine of the operating system's kernel.
std::string kernel_release();

/// Bytes of one instance of the first processor's cache of that level, 1 (data), 2 or 3; 0 where it has none or the
/// system does not tell.
std::size_t cache_bytes(int level);

/// Load averages over 1, 5 and 15 minutes; -1 where the system does not tell.
std::array<double, 3> load_averages();

}  // namespace lancet::runtime
