#pragma once

#include <chrono>
#include <thread>

#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::pipeline {

/// Returns at a time on steady_seconds(), or at once if it has passed.
inline void sleep_until(double time) {
    const double left = time - runtime::steady_seconds();
    if (left > 0) std::this_thread::sleep_for(std::chrono::duration<double>(left));
}

}  // namespace lancet::experiments::pipeline
