#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

namespace lancet::mesh {

/// A double and a bound of its distance to the exact value of the expression that made it: the fast number type of
/// predicates, which knows when it does not know.
struct Bounded {
    double value = 0;
    double error = 0;

    /// -1, +1 or 0 for an exact zero; meaningful where `is_certain`.
    int sign() const noexcept { return value > 0 ? 1 : value < 0 ? -1 : 0; }
    bool is_certain() const noexcept { return std::abs(value) > error || error == 0; }
    /// True where the value is exact to a relative `tolerance`.
    bool is_precise(double tolerance) const noexcept { return error < tolerance * std::abs(value) || error == 0; }

    static Bounded rounded(double value, double error) noexcept {
        // The bound itself is rounded: a few units more than it can lose.
        constexpr double unit = std::numeric_limits<double>::epsilon() / 2;
        return {value, (error + unit * std::abs(value)) * (1 + 8 * unit)};
    }
    friend Bounded operator+(const Bounded& a, const Bounded& b) noexcept {
        if (a.value == 0 && a.error == 0) return b;
        if (b.value == 0 && b.error == 0) return a;
        return rounded(a.value + b.value, a.error + b.error);
    }
    friend Bounded operator-(const Bounded& a) noexcept { return {-a.value, a.error}; }
    friend Bounded operator-(const Bounded& a, const Bounded& b) noexcept { return a + -b; }
    friend Bounded operator*(const Bounded& a, const Bounded& b) noexcept {
        const bool is_zero = (a.value == 0 && a.error == 0) || (b.value == 0 && b.error == 0);
        if (is_zero) return {};
        // What underflows is smaller than the smallest normal number.
        return rounded(a.value * b.value, std::abs(a.value) * b.error + std::abs(b.value) * a.error +
                                              a.error * b.error + std::numeric_limits<double>::min());
    }
};

/// Two doubles whose sum is the value, to about 2^-100, with a bound of its distance to the exact one: what
/// neighbouring facets that lie nearly in one plane leave undecided in one double, this decides without going over to
/// integers. The operations are those of Dekker (1971); their bounds are some times what they can lose.
struct Extended {
    double high = 0;
    double low = 0;  ///< about a unit in the last place of `high`
    double error = 0;

    int sign() const noexcept { return high > 0 ? 1 : high < 0 ? -1 : 0; }
    bool is_certain() const noexcept { return std::abs(high) > 2 * error || error == 0; }
    bool is_precise(double tolerance) const noexcept { return error < tolerance * std::abs(high) || error == 0; }
    Bounded bounded() const noexcept { return {high, low == 0 ? error : (std::abs(low) + error) * (1 + 0x1p-50)}; }

    /// A difference of two doubles is exact in two, unless it overflows; then it is not certain.
    static Extended difference(double a, double b) noexcept {
        const double high = a - b, back = high - a;
        return {high, (a - (high - back)) - (b + back), std::isfinite(high) ? 0 : high};
    }
    friend Extended operator-(const Extended& a) noexcept { return {-a.high, -a.low, a.error}; }
    friend Extended operator-(const Extended& a, const Extended& b) noexcept { return a + -b; }
    friend Extended operator+(const Extended& a, const Extended& b) noexcept {
        if (a.high == 0 && a.error == 0) return b;
        if (b.high == 0 && b.error == 0) return a;
        const double sum = a.high + b.high, back = sum - a.high;
        const double rest = ((a.high - (sum - back)) + (b.high - back)) + (a.low + b.low);
        return normalised(sum, rest, a.error + b.error + lost * (std::abs(a.high) + std::abs(b.high)));
    }
    friend Extended operator*(const Extended& a, const Extended& b) noexcept {
        const bool is_zero = (a.high == 0 && a.error == 0) || (b.high == 0 && b.error == 0);
        if (is_zero) return {};
        const double product = a.high * b.high;
        const auto [a_top, a_rest] = halves(a.high);
        const auto [b_top, b_rest] = halves(b.high);
        const double rest = (((a_top * b_top - product) + a_top * b_rest + a_rest * b_top) + a_rest * b_rest) +
                            (a.high * b.low + a.low * b.high);
        const double a_error = a.error * std::abs(b.high), b_error = b.error * std::abs(a.high);
        // What underflows is smaller than the smallest normal number.
        return normalised(product, rest,
                          (a_error + b_error) * (1 + 0x1p-50) + a.error * b.error + lost * std::abs(product) +
                              std::numeric_limits<double>::min());
    }

  private:
    static constexpr double lost = 0x1p-101;  ///< of each operation, in proportion to its terms
    static std::array<double, 2> halves(double a) noexcept {
        const double scaled = 134217729 * a;  // 2^27 + 1
        const double top = scaled - (scaled - a);
        return {top, a - top};
    }
    static Extended normalised(double high, double low, double error) noexcept {
        const double sum = high + low;
        return {sum, low - (sum - high), error * (1 + 0x1p-50)};
    }
};

/// A sum, difference or product of doubles without rounding: mantissa * 2^exponent.
class Exact {
  public:
    Exact() = default;
    Exact(double value) {
        if (value == 0) return;
        int exponent = 0;
        const double fraction = std::frexp(value, &exponent);
        mantissa_ = static_cast<std::int64_t>(std::ldexp(fraction, 53));
        exponent_ = exponent - 53;
    }

    int sign() const { return mantissa_.sign(); }
    /// The value as a double with its bound: half a unit in the last place, or, below the normal numbers, the smallest
    /// of these. What is not zero keeps its sign however small it is.
    Bounded bounded() const {
        if (sign() == 0) return {};
        using Limits = std::numeric_limits<double>;
        const auto magnitude = static_cast<Integer>(abs(mantissa_));
        const auto bits = static_cast<int>(msb(magnitude)) + 1;
        const int drop = bits > 64 ? bits - 64 : 0;
        const auto leading = static_cast<std::uint64_t>(magnitude >> drop);
        const double value = std::ldexp(static_cast<double>(leading), exponent_ + drop);
        if (value < Limits::min()) return {sign() * std::max(value, Limits::denorm_min()), Limits::min()};
        const bool is_exact = drop == 0 && bits <= 53;
        return {sign() * value, is_exact ? 0.0 : value * Limits::epsilon()};
    }
    /// The value as two doubles.
    Extended extended() const {
        const Bounded leading = bounded();
        if (leading.error == 0) return {leading.value, 0, 0};
        const Bounded rest = (*this - Exact(leading.value)).bounded();
        return {leading.value, rest.value, rest.error};
    }
    /// The e with 2^e <= |value| < 2^(e + 1); 0 for zero.
    int exponent() const {
        return sign() == 0 ? 0 : static_cast<int>(msb(static_cast<Integer>(abs(mantissa_)))) + exponent_;
    }
    /// The value times 2^exponent.
    Exact scaled(int exponent) const {
        Exact result = *this;
        if (sign() != 0) result.exponent_ += exponent;
        return result;
    }
    double value() const { return bounded().value; }

    friend Exact operator+(const Exact& a, const Exact& b) {
        if (a.sign() == 0) return b;
        if (b.sign() == 0) return a;
        Exact sum;
        sum.exponent_ = std::min(a.exponent_, b.exponent_);
        sum.mantissa_ = (a.mantissa_ << (a.exponent_ - sum.exponent_)) + (b.mantissa_ << (b.exponent_ - sum.exponent_));
        return sum;
    }
    friend Exact operator-(const Exact& a) {
        Exact negative = a;
        negative.mantissa_ = -negative.mantissa_;
        return negative;
    }
    friend Exact operator-(const Exact& a, const Exact& b) { return a + -b; }
    friend Exact operator*(const Exact& a, const Exact& b) {
        Exact product;
        product.mantissa_ = a.mantissa_ * b.mantissa_;
        product.exponent_ = a.exponent_ + b.exponent_;
        return product;
    }

  private:
    using Integer = boost::multiprecision::cpp_int;
    Integer mantissa_ = 0;
    int exponent_ = 0;
};

template <class Number>
Number dot(const std::array<Number, 4>& a, const std::array<Number, 4>& b) {
    return (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
}

template <class Number>
Number dot(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Number>
std::array<Number, 3> cross(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The vector orthogonal to three others in four dimensions: dot(d, cross(a, b, c)) = det(d, a, b, c).
template <class Number>
std::array<Number, 4> cross(const std::array<Number, 4>& a, const std::array<Number, 4>& b,
                            const std::array<Number, 4>& c) {
    const auto minor = [&](std::size_t i, std::size_t j) { return b[i] * c[j] - b[j] * c[i]; };
    const Number m01 = minor(0, 1), m02 = minor(0, 2), m03 = minor(0, 3), m12 = minor(1, 2), m13 = minor(1, 3),
                 m23 = minor(2, 3);
    return {a[1] * m23 - a[2] * m13 + a[3] * m12, -(a[0] * m23 - a[2] * m03 + a[3] * m02),
            a[0] * m13 - a[1] * m03 + a[3] * m01, -(a[0] * m12 - a[1] * m02 + a[2] * m01)};
}

}  // namespace lancet::mesh
