#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::collision {

/// One kind of broad phase in one scene. Times are medians over the steps of the shortest of all repetitions.
struct Row {
    std::string scene{};
    std::string kind{};
    std::int64_t primitives = 0;                ///< boxes that it is built over
    std::int64_t queries = 0;                   ///< boxes a step that it is asked with
    std::optional<double> ms_build{};           ///< from nothing: the shortest
    std::optional<double> ms_refit{};           ///< a step's
    std::optional<double> ms_query{};           ///< all queries of a step
    std::optional<double> ms_contacts{};        ///< queries and contacts of a step, as a simulation asks for them
    std::optional<double> rebuilds{};           ///< refits that built anew, of all
    std::optional<double> times_brute_force{};  ///< refit and query: how many times faster than brute force
    std::optional<std::int64_t> candidates{};   ///< pairs of boxes of a step, mean: the same for all kinds
    std::optional<std::int64_t> contacts{};     ///< true contacts of a step, mean
    std::optional<std::int64_t> unresolved{};   ///< vertices without a depth, mean
    std::optional<double> megabytes{};          ///< of the broad phase
    std::optional<double> noise_percent{};      ///< of refit and query: (largest - smallest) / median of repetitions
    std::string note{};
};

[[nodiscard]] Table make_table(std::span<const Row> rows);

}  // namespace lancet::experiments::collision
