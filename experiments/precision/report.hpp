#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/precision/advice.hpp"
#include "lancet/experiments/precision/run.hpp"

namespace lancet::experiments::precision {

/// A value that somebody else published, and ours.
struct Comparison {
    std::string problem, variant, quantity;
    double published = 0;
    double ours = 0;                ///< on the mesh of the reference
    double extrapolated = 0;        ///< from the two finest meshes
    double difference_percent = 0;  ///< of the extrapolated value
    double trusted_percent = 0;     ///< how far the published value may be trusted
    std::string source;
};

/// What L2 and energy norms are measured against: a solution of ours.
struct OwnReference {
    std::string problem, variant, what;
    double change_percent = 0;  ///< of the L2 norm by the last extrapolation: what is left is a small part of it
};

/// The rows with all their columns, for files.
[[nodiscard]] Table make_table(std::span<const Row> rows);
/// Rows of one problem as a person wants them: by time, the Pareto front marked with an asterisk.
[[nodiscard]] Table make_printed_table(std::span<const Row> rows);
/// "For an error of 10, 1, 0.1, 0.01 % use ...".
[[nodiscard]] Table make_advice_table(std::span<const Advice> advice, std::span<const Row> rows);
[[nodiscard]] Table make_budget_table(std::span<const BudgetLine> budget);
[[nodiscard]] Table make_omission_table(std::span<const Omission> omissions);
[[nodiscard]] Table make_comparison_table(std::span<const Comparison> comparisons);
[[nodiscard]] Table make_reference_table(std::span<const OwnReference> references);

/// The rows as JSON objects; `pareto` is true or false.
[[nodiscard]] nlohmann::ordered_json rows_json(std::span<const Row> rows);
/// The Pareto front of every problem and variant, by time: what is on it, its seconds and its error.
[[nodiscard]] nlohmann::ordered_json pareto_json(std::span<const Row> rows);

}  // namespace lancet::experiments::precision
