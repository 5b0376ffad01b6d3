#pragma once

#include <cstddef>

namespace lancet::runtime {

/// How much of the process is in main memory, in bytes.
struct ResidentMemory {
    std::size_t current = 0;
    std::size_t peak = 0;  ///< the largest since the process started
};

/// Reads the resident set sizes of this process from /proc/self/status (VmRSS and VmHWM).
/// Throws lancet::Error where they are not to be had.
ResidentMemory resident_memory();

}  // namespace lancet::runtime
