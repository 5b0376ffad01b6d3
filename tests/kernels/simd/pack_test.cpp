#include <cmath>
#include <cstring>
#include <limits>

#include "tests/kernels/simd/simd_test.hpp"

namespace lancet::kernels::test {

namespace {

template <class Real>
using Limits = std::numeric_limits<Real>;

/// Numbers of every kind; consecutive ones fill packs.
template <class Real>
std::vector<Real> numbers() {
    std::vector<Real> all = {Real(0),
                             Real(-0.0),
                             Real(1),
                             Real(-1),
                             Real(1.5),
                             Real(-2.75),
                             Real(1e-3),
                             Real(1e6),
                             Real(0.1),
                             Real(-0.3),
                             Limits<Real>::max(),
                             Limits<Real>::min(),
                             Limits<Real>::lowest(),
                             Limits<Real>::infinity(),
                             -Limits<Real>::infinity(),
                             Limits<Real>::quiet_NaN()};
    for (int i = 0; i < 16; ++i) all.push_back(Real(std::sin(i + 1.0) * std::pow(10.0, i % 7 - 3)));
    return all;
}

template <class Real>
bool equal_bits(Real a, Real b) {
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

template <class Real>
Real expected(Operation operation, Real a, Real b, Real c) {
    switch (operation) {
        case Operation::add:
        case Operation::add_assign:
            return a + b;
        case Operation::subtract:
        case Operation::subtract_assign:
            return a - b;
        case Operation::multiply:
        case Operation::multiply_assign:
            return a * b;
        case Operation::divide:
            return a / b;
        case Operation::negate:
            return -a;
        case Operation::minimum:
            return a < b ? a : b;
        case Operation::maximum:
            return a > b ? a : b;
        case Operation::absolute:
            return std::fabs(a);
        case Operation::root:
            return std::sqrt(a);
        case Operation::select_less:
            return a < b ? a : c;
        case Operation::select_finite:
            return std::isfinite(a) ? Real(1) : Real(0);
        case Operation::load_store:
            return a;
        case Operation::broadcast:
            return Real(0.75);
        case Operation::fma:
            return std::fma(a, b, c);
        case Operation::fnma:
            return std::fma(-a, b, c);
    }
    return a;
}

/// Calls check(a, b, c, lane pointers into packs) so that every pair of numbers meets in some lane.
template <class Real, class Check>
void for_packs(int width, Check check) {
    const std::vector<Real> all = numbers<Real>();
    const std::size_t size = all.size();
    std::vector<Real> a(width), b(width), c(width);
    for (std::size_t shift = 0; shift < size; ++shift) {
        for (std::size_t first = 0; first < size; first += static_cast<std::size_t>(width)) {
            for (std::size_t lane = 0; lane < static_cast<std::size_t>(width); ++lane) {
                a[lane] = all[(first + lane) % size];
                b[lane] = all[(first + lane + shift) % size];
                c[lane] = all[(first + 3 * lane + 2 * shift) % size];
            }
            check(a, b, c);
        }
    }
}

}  // namespace

class PackTest : public SimdTest {};

// The sign of zero is not promised: on AVX-512 the negative of zero is zero.
TEST_P(PackTest, ArithmeticRoundsLikeTheScalarType) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        for (const Operation operation :
             {Operation::add, Operation::subtract, Operation::multiply, Operation::divide, Operation::negate,
              Operation::minimum, Operation::maximum, Operation::absolute, Operation::root, Operation::select_less,
              Operation::select_finite, Operation::add_assign, Operation::subtract_assign, Operation::multiply_assign,
              Operation::load_store, Operation::broadcast}) {
            for_packs<Real>(probe.width, [&](const auto& a, const auto& b, const auto& c) {
                std::vector<Real> result(probe.width);
                probe.apply(operation, a.data(), b.data(), c.data(), result.data());
                for (std::size_t lane = 0; lane < result.size(); ++lane) {
                    const Real right = expected(operation, a[lane], b[lane], c[lane]);
                    EXPECT_TRUE(equal_bits(result[lane], right) || (result[lane] == 0 && right == 0))
                        << "operation " << static_cast<int>(operation) << " of " << a[lane] << ", " << b[lane] << ", "
                        << c[lane] << ": " << result[lane] << " instead of " << right;
                }
            });
        }
    });
}

TEST_P(PackTest, MultiplyAddIsFusedWhereTheInstructionSetFuses) {
    const bool fused = GetParam() == InstructionSet::avx2 || GetParam() == InstructionSet::avx512 ||
                       GetParam() == InstructionSet::neon;
    for_each_scalar([&]<class Real>(const SimdProbe<Real>& probe) {
        const auto check = [&](const auto& a, const auto& b, const auto& c) {
            std::vector<Real> plus(probe.width), minus(probe.width);
            probe.apply(Operation::fma, a.data(), b.data(), c.data(), plus.data());
            probe.apply(Operation::fnma, a.data(), b.data(), c.data(), minus.data());
            for (std::size_t lane = 0; lane < plus.size(); ++lane) {
                const volatile Real product = a[lane] * b[lane];
                EXPECT_TRUE(equal_bits(plus[lane], fused ? std::fma(a[lane], b[lane], c[lane]) : product + c[lane]));
                EXPECT_TRUE(equal_bits(minus[lane], fused ? std::fma(-a[lane], b[lane], c[lane]) : c[lane] - product));
            }
        };
        for_packs<Real>(probe.width, check);
        // (1 + e)(1 - e) - 1 = -e^2: fused keeps it, two roundings lose it.
        const Real e = std::sqrt(Limits<Real>::epsilon()) / 4;
        std::vector<Real> a(probe.width, 1 + e), b(probe.width, 1 - e), c(probe.width, Real(-1)), result(probe.width);
        probe.apply(Operation::fma, a.data(), b.data(), c.data(), result.data());
        for (const Real value : result) EXPECT_EQ(value != 0, fused);
    });
}

TEST_P(PackTest, ComparisonsAndMasks) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        for (const Comparison comparison :
             {Comparison::less, Comparison::less_equal, Comparison::greater, Comparison::greater_equal,
              Comparison::equal, Comparison::less_and_equal, Comparison::less_or_equal, Comparison::not_less}) {
            for_packs<Real>(probe.width, [&](const auto& a, const auto& b, const auto&) {
                std::vector<Real> ones(probe.width);
                bool any = false;
                bool all = false;
                probe.compare(comparison, a.data(), b.data(), ones.data(), &any, &all);
                int count = 0;
                for (std::size_t lane = 0; lane < ones.size(); ++lane) {
                    const bool truth[] = {a[lane]<b[lane], a[lane] <= b[lane], a[lane]> b[lane],
                                          a[lane] >= b[lane],
                                          a[lane] == b[lane],
                                          false,
                                          a[lane] <= b[lane],
                                          !(a[lane] < b[lane])};
                    const bool right = truth[static_cast<int>(comparison)];
                    EXPECT_EQ(ones[lane], Real(right)) << a[lane] << ", " << b[lane];
                    count += right ? 1 : 0;
                }
                EXPECT_EQ(any, count > 0);
                EXPECT_EQ(all, count == probe.width);
            });
        }
    });
}

TEST_P(PackTest, ReductionsAreExactAndOfFixedOrder) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        std::vector<Real> a(probe.width);
        for (std::size_t lane = 0; lane < a.size(); ++lane) a[lane] = Real(std::cos(double(lane)) * 1e3);
        std::vector<Real> half = a;
        for (std::size_t length = half.size() / 2; length > 0; length /= 2) {
            for (std::size_t lane = 0; lane < length; ++lane) half[lane] += half[lane + length];
        }
        EXPECT_EQ(probe.sum(a.data()), half[0]);
        for (std::size_t lane = 0; lane < a.size(); ++lane) {
            std::vector<Real> one(probe.width, Real(-5));
            one[lane] = Real(-2);
            EXPECT_EQ(probe.largest(one.data()), Real(-2)) << "lane " << lane;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, PackTest, ::testing::ValuesIn(compiled_instruction_sets()), set_name);

}  // namespace lancet::kernels::test
