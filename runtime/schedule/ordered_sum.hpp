#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// Several quantities that are summed in one pass, for example the products r.z and r.r of an iteration.
template <std::size_t Quantities>
struct Sums {
    std::array<double, Quantities> values{};

    double& operator[](std::size_t quantity) noexcept { return values[quantity]; }
    double operator[](std::size_t quantity) const noexcept { return values[quantity]; }

    Sums& operator+=(const Sums& other) noexcept {
        for (std::size_t quantity = 0; quantity < Quantities; ++quantity) values[quantity] += other.values[quantity];
        return *this;
    }

    friend bool operator==(const Sums&, const Sums&) = default;
};

/// The sum of the partial results of the blocks, added in block order, starting from zero: so its bits depend on the
/// blocks alone, not on the threads that filled them. `Partial` is double or Sums.
template <class Partial>
Partial sum_in_order(std::span<const Partial> partials) noexcept {
    Partial sum{};
    for (const Partial& partial : partials) sum += partial;
    return sum;
}

/// Calls partial(block), which returns the partial result of a block as a `Partial` (double or Sums), for every block
/// on the threads of `scheduler`, and adds the results in block order. `partials` has one place for each block and
/// keeps the partial results; the number of blocks must not depend on the number of threads. Rethrows what `partial`
/// throws.
template <class Partial, class Function>
Partial ordered_sum(Scheduler& scheduler, std::span<Partial> partials, const Function& partial) {
    scheduler.for_each_block(static_cast<int>(partials.size()),
                             [&](int block) { partials[static_cast<std::size_t>(block)] = partial(block); });
    return sum_in_order(std::span<const Partial>(partials));
}

}  // namespace lancet::runtime
