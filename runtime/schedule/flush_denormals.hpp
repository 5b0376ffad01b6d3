#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace lancet::runtime {

/// While it lives, the calling thread replaces denormal results by zero (flush to zero) and takes denormal operands as
/// zero (denormals are zero); its destructor restores the mode found. Denormal operands cost a hundred cycles and
/// more, and decaying motions are full of them. x86-64: bits FTZ and DAZ of MXCSR. AArch64: bit FZ of FPCR.
class FlushDenormals {
  public:
    FlushDenormals() noexcept : found_(read()) {
        // Reading the register is cheap, writing it is not.
        if ((found_ & flush_bits) != flush_bits) write(found_ | flush_bits);
    }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;
    ~FlushDenormals() {
        if ((found_ & flush_bits) != flush_bits) write((read() & ~flush_bits) | (found_ & flush_bits));
    }

    /// True if the calling thread flushes denormals now.
    static bool active() noexcept { return (read() & flush_bits) == flush_bits; }

  private:
#if defined(__SSE2__)
    using Register = std::uint32_t;
    static constexpr Register flush_bits = 0x8000U | 0x0040U;
    static Register read() noexcept {
        return _mm_getcsr();
    }
    static void write(Register value) noexcept {
        _mm_setcsr(value);
    }
#elif defined(__aarch64__)
    using Register = std::uint64_t;
    static constexpr Register flush_bits = Register{1} << 24U;
    static Register read() noexcept {
        Register value = 0;
        __asm__ volatile("mrs %0, fpcr" : "=r"(value));
        return value;
    }
    static void write(Register value) noexcept {
        __asm__ volatile("msr fpcr, %0" : : "r"(value) : "memory");
    }
#else
#error "FlushDenormals knows x86-64 and AArch64; add the floating-point control register of this target"
#endif

    Register found_;
};

}  // namespace lancet::runtime
