#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

/// Something that is due so often in simulated time.
class Rate {
  public:
    /// In 1 / s; 0: never. Throws lancet::Error for what is negative or not finite.
    explicit Rate(double per_second = 0) : per_second_(per_second) {
        if (!(per_second >= 0) || !std::isfinite(per_second)) {
            throw Error("rate: " + std::to_string(per_second) + " per second; expected a number of at least 0");
        }
    }

    bool ever() const noexcept { return per_second_ > 0; }
    double per_second() const noexcept { return per_second_; }

    /// Whether it is due at this time; asked for times that grow. What became due several times since counts once.
    bool due(double time) noexcept {
        if (!ever()) return false;
        // Times are sums of steps: a millionth of a period early is on time.
        const auto periods = static_cast<std::int64_t>(std::floor(time * per_second_ + 1e-6));
        if (periods < next_) return false;
        next_ = periods + 1;
        return true;
    }

  private:
    double per_second_;
    std::int64_t next_ = 0;
};

}  // namespace lancet::runtime
