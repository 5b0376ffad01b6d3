#include "lancet/runtime/observe/stream_loops.hpp"

#include <cstddef>

namespace lancet::runtime {
namespace {

// Always inlined: each caller compiles it for its own instruction set. Vector is a GCC vector type, which both GCC and
// Clang map to the registers of the caller.
template <std::size_t Bytes>
struct VectorOf {
    using Type [[gnu::vector_size(Bytes), gnu::aligned(8), gnu::may_alias]] = double;
};

template <std::size_t Bytes>
[[gnu::always_inline]] inline double sum(std::span<const double> values) noexcept {
    using Vector = typename VectorOf<Bytes>::Type;
    constexpr std::size_t width = Bytes / sizeof(double);
    constexpr std::size_t sums = 8;
    Vector partial[sums] = {};
    std::size_t index = 0;
    for (; index + sums * width <= values.size(); index += sums * width) {
        for (std::size_t k = 0; k < sums; ++k) {
            partial[k] += *reinterpret_cast<const Vector*>(values.data() + index + k * width);
        }
    }
    double total = 0;
    for (const Vector& vector : partial) {
        for (std::size_t lane = 0; lane < width; ++lane) total += vector[lane];
    }
    for (; index < values.size(); ++index) total += values[index];
    return total;
}

template <std::size_t Bytes>
[[gnu::always_inline]] inline void triad(std::span<double> result, std::span<const double> a, std::span<const double> b,
                                         double factor) noexcept {
    using Vector = typename VectorOf<Bytes>::Type;
    constexpr std::size_t width = Bytes / sizeof(double);
    std::size_t index = 0;
    for (; index + width <= result.size(); index += width) {
        *reinterpret_cast<Vector*>(result.data() + index) = *reinterpret_cast<const Vector*>(a.data() + index) +
                                                            factor * *reinterpret_cast<const Vector*>(b.data() + index);
    }
    for (; index < result.size(); ++index) result[index] = a[index] + factor * b[index];
}

#if defined(__x86_64__)
[[gnu::target("avx")]] double sum_avx(std::span<const double> values) noexcept {
    return sum<32>(values);
}
[[gnu::target("avx")]] void triad_avx(std::span<double> result, std::span<const double> a, std::span<const double> b,
                                      double factor) noexcept {
    triad<32>(result, a, b, factor);
}
bool has_avx() noexcept {
    return __builtin_cpu_supports("avx") != 0;
}
#endif

}  // namespace

double stream_sum(std::span<const double> values) noexcept {
#if defined(__x86_64__)
    if (has_avx()) return sum_avx(values);
#endif
    return sum<16>(values);
}

void stream_triad(std::span<double> result, std::span<const double> a, std::span<const double> b,
                  double factor) noexcept {
#if defined(__x86_64__)
    if (has_avx()) {
        triad_avx(result, a, b, factor);
        return;
    }
#endif
    triad<16>(result, a, b, factor);
}

}  // namespace lancet::runtime
