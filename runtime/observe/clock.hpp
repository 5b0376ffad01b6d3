#pragma once

#include <chrono>

namespace lancet::runtime {

/// Seconds on the steady clock: only differences mean something.
inline double steady_seconds() noexcept {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace lancet::runtime
