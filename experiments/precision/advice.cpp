#include "lancet/experiments/precision/advice.hpp"

#include <algorithm>

#include "lancet/experiments/precision/pareto.hpp"

namespace lancet::experiments::precision {
namespace {

/// The fastest of `candidates` with an error of at most `limit`; there must be one.
std::size_t fastest(std::span<const Row> rows, const std::vector<std::size_t>& candidates, double limit) {
    std::size_t best = candidates.front();
    bool found = false;
    for (const std::size_t i : candidates) {
        if (rows[i].errors.judged() > limit || (found && rows[i].seconds >= rows[best].seconds)) continue;
        best = i;
        found = true;
    }
    return best;
}

}  // namespace

std::vector<Advice> give_advice(std::span<const Row> rows) {
    std::vector<Advice> all;
    for (std::size_t first = 0; first < rows.size(); ++first) {
        const auto is_same = [&](const Row& row) {
            return row.problem == rows[first].problem && row.variant == rows[first].variant;
        };
        bool is_new = true;
        for (std::size_t before = 0; before < first; ++before) is_new = is_new && !is_same(rows[before]);
        if (!is_new) continue;
        std::vector<std::size_t> candidates;
        double smallest = rows[first].errors.judged();
        for (std::size_t i = first; i < rows.size(); ++i) {
            if (!is_same(rows[i])) continue;
            candidates.push_back(i);
            smallest = std::min(smallest, rows[i].errors.judged());
        }
        for (const double target : advice_targets) {
            const bool is_reached = smallest <= target;
            const double limit = is_reached ? target : smallest * (1 + worthwhile_gain);
            all.push_back(
                {rows[first].problem, rows[first].variant, target, fastest(rows, candidates, limit), is_reached});
        }
    }
    return all;
}

std::string BudgetLine::dominating() const {
    std::string name = "nothing";
    double largest = 0;
    const auto compare = [&](const std::optional<double>& part, const char* what) {
        if (!part || !(*part > largest)) return;
        largest = *part;
        name = what;
    };
    compare(time_step, "time step");
    compare(linearisation, "linearisation");
    compare(mesh, "mesh");
    compare(solve, "linear solve");
    compare(scalar, "float");
    return name;
}

}  // namespace lancet::experiments::precision
