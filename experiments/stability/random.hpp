#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>

namespace lancet::experiments::stability {

/// Random numbers that are the same on every machine for the same seed: the generator is the standard's, and what is
/// made of its bits is written here, for the standard leaves its distributions to the library.
class Random {
  public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}

    /// In [0, 1), a multiple of 2^-53.
    double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Between two positive numbers, with uniform logarithm.
    double logarithmic(double low, double high) { return low * std::exp(uniform() * std::log(high / low)); }
    /// In [0, count).
    std::size_t below(std::size_t count) { return static_cast<std::size_t>(uniform() * static_cast<double>(count)); }
    int between(int low, int high) { return low + static_cast<int>(below(static_cast<std::size_t>(high - low + 1))); }
    bool chance(double probability) { return uniform() < probability; }
    template <class Value>
    const Value& pick(std::span<const Value> values) {
        return values[below(values.size())];
    }

    /// Uniform on the unit sphere.
    std::array<double, 3> direction() {
        while (true) {
            const std::array<double, 3> v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            const double length = std::hypot(v[0], v[1], v[2]);
            if (length > 0.1 && length <= 1) return {v[0] / length, v[1] / length, v[2] / length};
        }
    }
    /// Uniform in a tetrahedron: barycentric coordinates.
    std::array<double, 4> barycentric() {
        std::array<double, 4> b{};
        double sum = 0;
        for (double& value : b) sum += value = -std::log(1 - uniform());
        for (double& value : b) value /= sum;
        return b;
    }

  private:
    std::mt19937_64 bits_;
};

}  // namespace lancet::experiments::stability
