#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace lancet::runtime {

/// Tells the core that a thread looks at a value again and again.
inline void pause_thread() noexcept {
#if defined(__SSE2__)
    _mm_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

}  // namespace lancet::runtime
