#pragma once

#include <cstdint>
#include <optional>

namespace lancet::experiments {

/// How much main memory a piece of work takes at most, beyond what the process held before it.
///
/// Free memory goes back to the system and the kernel's record of the peak is reset when this is made, so that what the
/// work allocates counts page by page even where an earlier piece had used the same addresses.
class PeakMemory {
  public:
    PeakMemory();

    /// Bytes since construction; nothing where the system does not let a process reset its peak.
    [[nodiscard]] std::optional<std::int64_t> bytes() const;

  private:
    std::optional<std::int64_t> before_;
};

}  // namespace lancet::experiments
