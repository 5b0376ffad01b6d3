#include "lancet/experiments/bar/rows.hpp"

#include <algorithm>
#include <string>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

/// numerator / denominator, missing where that has no meaning.
Cell ratio(double numerator, double denominator) {
    if (!(denominator > 0)) return {};
    return numerator / denominator;
}

Cell cell(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

struct Field {
    Column column;
    Cell (*value)(const Row&);
};

/// The columns in order: name in files, heading, unit, digits, printed or not, and the value.
std::vector<Field> fields() {
    return {
        {{"method", "method", ""}, [](const Row& r) -> Cell { return r.report.method; }},
        {{"setting", "setting", ""}, [](const Row& r) -> Cell { return r.job.setting; }},
        {{"variant", "variant", ""}, [](const Row& r) -> Cell { return r.report.variant; }},
        {{"operator", "operator", ""}, [](const Row& r) -> Cell { return r.report.operator_; }},
        {{"scalar", "scalar", ""}, [](const Row& r) -> Cell { return r.report.scalar; }},
        {{"isa", "isa", ""}, [](const Row& r) -> Cell { return r.report.isa; }},
        {{"scheduler", "scheduler", ""}, [](const Row& r) -> Cell { return r.report.scheduler; }},
        {{"threads", "threads", ""}, [](const Row& r) -> Cell { return std::int64_t{r.report.threads}; }},
        {{"elements", "elements", "", 3, false}, [](const Row& r) -> Cell { return r.report.elements; }},
        {{"nodes", "nodes", "", 3, false}, [](const Row& r) -> Cell { return r.report.nodes; }},
        {{"steps", "steps", "", 3, false}, [](const Row& r) -> Cell { return r.report.steps; }},
        {{"seconds", "time", "s"}, [](const Row& r) -> Cell { return r.seconds; }},
        {{"seconds_minimum", "min", "s"}, [](const Row& r) -> Cell { return r.seconds_minimum; }},
        {{"seconds_maximum", "max", "s"}, [](const Row& r) -> Cell { return r.seconds_maximum; }},
        {{"seconds_setup", "setup", "s", 2, false}, [](const Row& r) -> Cell { return r.report.seconds_setup; }},
        {{"ms_per_step", "step", "ms"},
         [](const Row& r) { return ratio(1e3 * r.seconds, static_cast<double>(r.report.steps)); }},
        {{"times_real_time", "real time", "x"}, [](const Row& r) { return ratio(r.simulated_seconds, r.seconds); }},
        {{"speedup_over_eigen", "/ eigen", "x"}, [](const Row& r) { return cell(r.speedup_over_eigen); }},
        {{"speedup_over_thesis", "/ thesis", "x"}, [](const Row& r) { return cell(r.speedup_over_thesis); }},
        {{"speedup_over_one_thread", "/ 1 thread", "x"}, [](const Row& r) { return cell(r.speedup_over_one_thread); }},
        {{"share_forces_percent", "forces", "%"},
         [](const Row& r) { return ratio(100 * r.report.seconds_forces, r.report.seconds_total); }},
        {{"share_solve_percent", "CG", "%"},
         [](const Row& r) { return ratio(100 * r.report.seconds_solve, r.report.seconds_total); }},
        {{"share_rest_percent", "rest", "%"},
         [](const Row& r) { return ratio(100 * r.report.seconds_rest, r.report.seconds_total); }},
        {{"cg_iterations_per_step", "CG/step", ""},
         [](const Row& r) {
             return ratio(static_cast<double>(r.report.cg_iterations_total), static_cast<double>(r.report.steps));
         }},
        {{"repeats", "repeats", "", 3, false}, [](const Row& r) -> Cell { return r.report.repeats_total; }},
        {{"ns_per_element_iteration", "el. iter.", "ns"},
         [](const Row& r) {
             return ratio(1e9 * r.report.seconds_solve,
                          static_cast<double>(r.report.elements) * static_cast<double>(r.report.cg_iterations_total));
         }},
        {{"gflops", "CG", "GFLOP/s"},
         [](const Row& r) { return ratio(1e-9 * r.report.solve_flops, r.report.seconds_solve); }},
        {{"gbytes_per_s", "CG", "GB/s"},
         [](const Row& r) { return ratio(1e-9 * r.report.solve_bytes, r.report.seconds_solve); }},
        {{"bytes_per_element", "memory", "B/el."},
         [](const Row& r) {
             return ratio(static_cast<double>(r.report.bytes), static_cast<double>(r.report.elements));
         }},
        {{"error_t1_percent", "err 1 s", "%"}, [](const Row& r) { return cell(r.errors.t1); }},
        {{"error_t1_dt0_percent", "dt -> 0", "%"}, [](const Row& r) { return cell(r.errors.t1_dt0); }},
        {{"error_t5_percent", "err 5 s", "%"}, [](const Row& r) { return cell(r.errors.t5); }},
        {{"error_rest_percent", "err rest", "%"}, [](const Row& r) { return cell(r.errors.rest); }},
        {{"energy_final", "energy", "J", 4, false}, [](const Row& r) -> Cell { return r.report.energy_final; }},
    };
}

const Row* find(const std::vector<Row>& rows, const auto& condition) {
    const auto found = std::find_if(rows.begin(), rows.end(), condition);
    return found == rows.end() ? nullptr : &*found;
}

}  // namespace

Row make_row(const Job& job, const std::vector<WorkerReport>& reports, const Errors& errors, double time_step) {
    if (reports.empty()) throw Error(job.label() + ": no reports found, expected at least one");
    std::vector<double> totals;
    totals.reserve(reports.size());
    for (const WorkerReport& report : reports) totals.push_back(report.seconds_total);
    const Summary summary = summarize(totals);
    std::vector<std::size_t> order(reports.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&totals](std::size_t a, std::size_t b) { return totals[a] < totals[b]; });
    Row row;
    row.job = job;
    row.report = reports[order[(order.size() - 1) / 2]];
    row.seconds = summary.median;
    row.seconds_minimum = summary.minimum;
    row.seconds_maximum = summary.maximum;
    row.simulated_seconds = static_cast<double>(row.report.steps) * time_step;
    row.errors = errors;
    return row;
}

void add_speedups(std::vector<Row>& rows) {
    for (Row& row : rows) {
        const auto over = [&row](const Row* other) -> std::optional<double> {
            if (other == nullptr || !(row.seconds > 0)) return std::nullopt;
            return other->seconds / row.seconds;
        };
        const auto baseline = [&](const std::string& method) {
            return over(find(rows, [&](const Row& other) {
                return other.report.method == method && other.job.setting == row.job.setting &&
                       other.report.scalar == row.report.scalar && other.report.threads == 1;
            }));
        };
        row.speedup_over_eigen = baseline("eigen");
        row.speedup_over_thesis = baseline("thesis");
        const auto one_thread = [&](bool any_scheduler) {
            return find(rows, [&row, any_scheduler](const Row& other) {
                return other.report.threads == 1 && other.report.method == row.report.method &&
                       other.job.setting == row.job.setting && other.report.scalar == row.report.scalar &&
                       other.report.isa == row.report.isa && other.report.operator_ == row.report.operator_ &&
                       (any_scheduler || other.report.scheduler == row.report.scheduler);
            });
        };
        const Row* same_scheduler = one_thread(false);
        row.speedup_over_one_thread = over(same_scheduler != nullptr ? same_scheduler : one_thread(true));
    }
}

Table make_table(std::span<const Row> rows) {
    const std::vector<Field> all = fields();
    std::vector<Column> columns;
    columns.reserve(all.size());
    for (const Field& field : all) columns.push_back(field.column);
    Table table(columns);
    for (const Row& row : rows) {
        std::vector<Cell> cells;
        cells.reserve(all.size());
        for (const Field& field : all) cells.push_back(field.value(row));
        table.add_row(std::move(cells));
    }
    return table;
}

}  // namespace lancet::experiments::bar
