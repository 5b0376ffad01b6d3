#pragma once

#include <iosfwd>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/stability/case.hpp"

namespace lancet::experiments::stability {

/// A case and how it ended.
struct Outcome {
    Case one;
    Verdict verdict;
};

/// One line of JSON, and back: how a worker tells its parent.
nlohmann::ordered_json verdict_json(const Verdict& verdict);
Verdict verdict_of(const nlohmann::ordered_json& document);

/// What survives, by category, detail, enrichment, lumping, material and scalar.
Table survival_table(std::span<const Outcome> outcomes);
/// Counts of each category.
Table category_table(std::span<const Outcome> outcomes);
/// Every failure with the case and the seed that bring it back.
Table failure_table(std::span<const Outcome> outcomes);

/// The tables, the failures (of each kind the first few), and below them what survives means.
void print_report(std::ostream& stream, std::span<const Outcome> outcomes);
/// Counts, rows and all failures.
nlohmann::ordered_json report_json(std::span<const Outcome> outcomes);

/// Failures of what the method is made for.
std::size_t promised_failures(std::span<const Outcome> outcomes);

}  // namespace lancet::experiments::stability
