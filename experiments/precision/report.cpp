#include "lancet/experiments/precision/report.hpp"

#include <algorithm>
#include <numeric>

namespace lancet::experiments::precision {
namespace {

Cell optional_cell(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}
/// Words and numbers that do not apply are missing.
Cell word(const std::string& text) {
    return text.empty() ? Cell() : Cell(text);
}
Cell positive(double value) {
    return value > 0 ? Cell(value) : Cell();
}
Cell positive_count(std::int64_t value) {
    return value > 0 ? Cell(value) : Cell();
}

std::string cells_text(const std::array<int, 3>& cells) {
    return std::to_string(cells[0]) + "x" + std::to_string(cells[1]) + "x" + std::to_string(cells[2]);
}

std::vector<std::size_t> by_time(std::span<const Row> rows) {
    std::vector<std::size_t> order(rows.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rows[a].seconds < rows[b].seconds; });
    return order;
}

/// Slowest less fastest run against the median; missing for a single run.
Cell range_percent(const Row& row) {
    return row.repetitions > 1 ? Cell(100 * (row.seconds_maximum - row.seconds_minimum) / row.seconds) : Cell();
}

bool any(std::span<const Row> rows, const auto& has) {
    return std::any_of(rows.begin(), rows.end(), has);
}

}  // namespace

Table make_table(std::span<const Row> rows) {
    Table table({{"problem"},
                 {"variant"},
                 {"method"},
                 {"series"},
                 {"operator"},
                 {"scalar"},
                 {"preconditioner"},
                 {"integrator"},
                 {"linearisation"},
                 {"tangent"},
                 {"rotation"},
                 {"rotation_interval"},
                 {"cells"},
                 {"elements"},
                 {"dt"},
                 {"tolerance"},
                 {"iterations_limit"},
                 {"newton_tolerance"},
                 {"scheduler"},
                 {"threads"},
                 {"isa"},
                 {"seconds"},
                 {"seconds_minimum"},
                 {"seconds_maximum"},
                 {"repetitions"},
                 {"flops"},
                 {"bytes"},
                 {"iterations"},
                 {"error_l2"},
                 {"error_energy"},
                 {"error_qoi"},
                 {"qoi"},
                 {"drift_energy"},
                 {"drift_angular_momentum"},
                 {"pareto"},
                 {"outcome"}});
    for (const Row& row : rows) {
        const Setting& s = row.setting;
        table.add_row({row.problem,
                       word(row.variant),
                       s.method,
                       s.series,
                       word(s.operator_),
                       s.scalar,
                       word(s.preconditioner),
                       word(s.integrator),
                       word(s.linearisation),
                       word(s.tangent),
                       word(s.rotation),
                       positive_count(s.rotation_interval),
                       cells_text(s.cells),
                       static_cast<std::int64_t>(row.elements),
                       positive(s.time_step),
                       positive(s.tolerance),
                       positive_count(s.iterations),
                       positive(s.newton_tolerance),
                       s.scheduler,
                       std::int64_t{s.threads},
                       s.instruction_set,
                       row.seconds,
                       row.seconds_minimum,
                       row.seconds_maximum,
                       std::int64_t{row.repetitions},
                       row.solution.flops,
                       row.solution.bytes ? Cell(*row.solution.bytes) : Cell(),
                       row.solution.iterations,
                       optional_cell(row.errors.l2),
                       optional_cell(row.errors.energy),
                       optional_cell(row.errors.quantity),
                       row.errors.value,
                       optional_cell(row.solution.drift_energy),
                       optional_cell(row.solution.drift_momentum),
                       std::int64_t{row.pareto ? 1 : 0},
                       row.solution.outcome});
    }
    return table;
}

Table make_printed_table(std::span<const Row> rows) {
    const bool moves = any(rows, [](const Row& row) { return row.setting.time_step > 0; });
    const bool threads = any(rows, [](const Row& row) { return row.setting.threads > 1; });
    const bool sets = any(rows, [&](const Row& row) {
        return row.setting.method == rows.front().setting.method &&
               row.setting.instruction_set != rows.front().setting.instruction_set;
    });
    Table table({{"pareto", ""},
                 {"method", "method"},
                 {"scalar", "scalar"},
                 {"operator", "operator"},
                 {"preconditioner", "preconditioner"},
                 {"integrator", "integrator", "", 3, moves},
                 {"other", "else"},
                 {"threads", "threads", "", 3, threads},
                 {"isa", "isa", "", 3, sets},
                 {"cells", "cells"},
                 {"dt", "dt", "s", 3, moves},
                 {"tolerance", "tolerance", "", 1},
                 {"seconds", "time", "s"},
                 {"spread", "range", "%", 2},
                 {"iterations", "CG its"},
                 {"megabytes", "memory", "MB"},
                 {"error_l2", "error L2", "%"},
                 {"error_energy", "energy norm", "%"},
                 {"error_qoi", "quantity", "%"}});
    for (const std::size_t i : by_time(rows)) {
        const Row& row = rows[i];
        const Setting& s = row.setting;
        std::string other;
        const auto add = [&other](bool is_so, const std::string& text) {
            if (is_so) other += (other.empty() ? "" : ", ") + text;
        };
        add(!s.tangent.empty() && s.tangent != "exact", s.tangent + " tangent");
        add(!s.rotation.empty() && s.rotation != "robust", s.rotation);
        add(s.rotation_interval > 1, "rotations every " + std::to_string(s.rotation_interval));
        add(s.linearisation == "state", "at state");
        add(s.newton_tolerance > 0, "iterated");
        add(s.iterations > 0 && s.tolerance == 0, std::to_string(s.iterations) + " its");
        add(row.solution.outcome.starts_with("stagnated"), "stagnated");
        table.add_row(
            {std::string(row.pareto ? "*" : ""), s.method, s.scalar, word(s.operator_), word(s.preconditioner),
             word(s.integrator), word(other), std::int64_t{s.threads}, s.instruction_set, cells_text(s.cells),
             positive(s.time_step), positive(s.tolerance), row.seconds, range_percent(row), row.solution.iterations,
             row.solution.bytes ? Cell(static_cast<double>(*row.solution.bytes) / 1e6) : Cell(),
             optional_cell(row.errors.l2), optional_cell(row.errors.energy), optional_cell(row.errors.quantity)});
    }
    return table;
}

Table make_advice_table(std::span<const Advice> advice, std::span<const Row> rows) {
    Table table({{"problem", "problem"},
                 {"variant", "variant"},
                 {"target_percent", "for an error of", "%"},
                 {"reached", "reached"},
                 {"use", "use"},
                 {"seconds", "time", "s"},
                 {"error", "error", "%"}});
    for (const Advice& one : advice) {
        const Row& row = rows[one.row];
        table.add_row({one.problem, word(one.variant), one.target_percent,
                       std::string(one.reached ? "yes" : "no, best"), row.setting.label(), row.seconds,
                       row.errors.judged()});
    }
    return table;
}

Table make_budget_table(std::span<const BudgetLine> budget) {
    Table table({{"problem", "problem"},
                 {"variant", "variant"},
                 {"setting", "setting"},
                 {"time_step", "time step", "%", 2},
                 {"linearisation", "linearised once", "%", 2},
                 {"mesh", "mesh", "%", 2},
                 {"solve", "linear solve", "%", 2},
                 {"float", "float", "%", 2},
                 {"total", "together", "%", 2},
                 {"total_is_of", "of"},
                 {"dominates", "dominates"}});
    for (const BudgetLine& line : budget) {
        table.add_row({line.problem, word(line.variant), line.setting, optional_cell(line.time_step),
                       optional_cell(line.linearisation), optional_cell(line.mesh), optional_cell(line.solve),
                       optional_cell(line.scalar), line.total,
                       std::string(line.total_has_mesh ? "all" : "all but the mesh"), line.dominating()});
    }
    return table;
}

Table make_omission_table(std::span<const Omission> omissions) {
    Table table({{"problem", "problem"},
                 {"variant", "variant"},
                 {"setting", "setting"},
                 {"kind", "what"},
                 {"explanation", "how"}});
    for (const Omission& one : omissions) {
        table.add_row({one.problem, word(one.variant), one.setting.label(), one.kind, one.explanation});
    }
    return table;
}

Table make_comparison_table(std::span<const Comparison> comparisons) {
    Table table({{"problem", "problem"},
                 {"variant", "variant"},
                 {"quantity", "quantity"},
                 {"published", "published", "m", 5},
                 {"ours", "finest mesh", "m", 5},
                 {"extrapolated", "extrapolated", "m", 5},
                 {"difference_percent", "difference", "%", 2},
                 {"trusted_percent", "trusted to", "%", 2},
                 {"source", "source"}});
    for (const Comparison& one : comparisons) {
        table.add_row({one.problem, word(one.variant), one.quantity, one.published, one.ours, one.extrapolated,
                       one.difference_percent, one.trusted_percent, one.source});
    }
    return table;
}

Table make_reference_table(std::span<const OwnReference> references) {
    Table table({{"problem", "problem"},
                 {"variant", "variant"},
                 {"reference", "reference of the norms, our own"},
                 {"change_percent", "changed by extrapolation", "%", 2}});
    for (const OwnReference& one : references) {
        table.add_row({one.problem, word(one.variant), one.what, one.change_percent});
    }
    return table;
}

nlohmann::ordered_json rows_json(std::span<const Row> rows) {
    nlohmann::ordered_json json = make_table(rows).to_json();
    for (nlohmann::ordered_json& row : json) row["pareto"] = row.at("pareto").get<int>() != 0;
    return json;
}

nlohmann::ordered_json pareto_json(std::span<const Row> rows) {
    nlohmann::ordered_json fronts = nlohmann::ordered_json::array();
    for (const std::size_t i : by_time(rows)) {
        const Row& row = rows[i];
        if (!row.pareto) continue;
        fronts.push_back({{"problem", row.problem},
                          {"variant", row.variant},
                          {"row", i},
                          {"setting", row.setting.label()},
                          {"threads", row.setting.threads},
                          {"seconds", row.seconds},
                          {"error", row.errors.judged()}});
    }
    std::stable_sort(fronts.begin(), fronts.end(), [](const auto& a, const auto& b) {
        return a.at("problem") != b.at("problem") ? a.at("problem") < b.at("problem")
                                                  : a.at("variant") < b.at("variant");
    });
    return fronts;
}

}  // namespace lancet::experiments::precision
