#include "lancet/experiments/scaling/rows.hpp"

#include <algorithm>
#include <set>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

/// numerator / denominator, missing where that has no meaning.
Cell ratio(double numerator, double denominator) {
    if (!(denominator > 0)) return {};
    return numerator / denominator;
}

Cell cell(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

Cell share(const std::optional<double>& value, double of) {
    return value ? ratio(100 * *value, of) : Cell();
}

double gflops(const Row& row) {
    const bar::WorkerReport& run = row.report.run;
    return run.seconds_solve > 0 ? 1e-9 * run.solve_flops / run.seconds_solve : 0;
}

double gbytes_per_s(const Row& row) {
    const bar::WorkerReport& run = row.report.run;
    return run.seconds_solve > 0 ? 1e-9 * run.solve_bytes / run.seconds_solve : 0;
}

struct Field {
    Column column;
    Cell (*value)(const Row&);
};

std::vector<Field> fields() {
    return {
        {{"series", "series", ""}, [](const Row& r) -> Cell { return r.series; }},
        {{"problem", "problem", ""}, [](const Row& r) -> Cell { return r.job.benchmark; }},
        {{"setting", "setting", ""}, [](const Row& r) -> Cell { return r.job.setting; }},
        {{"elements", "elements", ""}, [](const Row& r) -> Cell { return r.report.run.elements; }},
        {{"nodes", "nodes", ""}, [](const Row& r) -> Cell { return r.report.run.nodes; }},
        {{"steps", "steps", ""}, [](const Row& r) -> Cell { return r.report.run.steps; }},
        {{"scheduler", "scheduler", ""},
         [](const Row& r) -> Cell {
             return r.job.is_natural_order ? std::string("natural order") : r.report.run.scheduler;
         }},
        {{"threads", "threads", ""}, [](const Row& r) -> Cell { return std::int64_t{r.report.run.threads}; }},
        {{"isa", "isa", ""}, [](const Row& r) -> Cell { return r.report.run.isa; }},
        {{"scalar", "scalar", ""}, [](const Row& r) -> Cell { return r.report.run.scalar; }},
        {{"operator", "operator", ""}, [](const Row& r) -> Cell { return r.report.run.operator_; }},
        {{"scatter", "scatter", ""},
         [](const Row& r) -> Cell {
             if (r.job.is_natural_order) return {};
             return r.job.scatter;
         }},
        {{"ms_per_step", "step", "ms"}, [](const Row& r) -> Cell { return r.ms_per_step; }},
        {{"ms_minimum", "min", "ms"}, [](const Row& r) -> Cell { return r.ms_minimum; }},
        {{"ms_maximum", "max", "ms"}, [](const Row& r) -> Cell { return r.ms_maximum; }},
        {{"spread_percent", "spread", "%", 2}, [](const Row& r) { return cell(r.spread_percent); }},
        {{"repetitions", "runs", ""}, [](const Row& r) -> Cell { return static_cast<std::int64_t>(r.repetitions); }},
        {{"repetitions_counted", "counted", ""},
         [](const Row& r) -> Cell { return static_cast<std::int64_t>(r.counted); }},
        {{"seconds", "whole run", "s"}, [](const Row& r) -> Cell { return r.seconds(); }},
        {{"speedup", "/ 1 thread", "x"}, [](const Row& r) { return cell(r.speedup); }},
        {{"efficiency_percent", "eff.", "%"},
         [](const Row& r) { return share(r.speedup, static_cast<double>(r.report.run.threads)); }},
        {{"speedup_over_serial", "/ natural", "x"}, [](const Row& r) { return cell(r.speedup_over_serial); }},
        {{"efficiency_over_serial_percent", "eff.", "%"},
         [](const Row& r) { return share(r.speedup_over_serial, static_cast<double>(r.report.run.threads)); }},
        {{"cg_share_percent", "CG", "%"},
         [](const Row& r) { return ratio(100 * r.report.run.seconds_solve, r.report.run.seconds_total); }},
        {{"cg_iterations_per_step", "CG/step", ""},
         [](const Row& r) {
             return ratio(static_cast<double>(r.report.run.cg_iterations_total),
                          static_cast<double>(r.report.run.steps));
         }},
        {{"bytes_per_element", "memory", "B/el."},
         [](const Row& r) {
             return ratio(static_cast<double>(r.report.run.bytes), static_cast<double>(r.report.run.elements));
         }},
        {{"gflops", "CG", "GFLOP/s"}, [](const Row& r) -> Cell { return gflops(r); }},
        {{"gflops_share_percent", "of peak", "%"}, [](const Row& r) { return ratio(100 * gflops(r), r.peak_gflops); }},
        {{"gbytes_per_s", "CG", "GB/s"}, [](const Row& r) -> Cell { return gbytes_per_s(r); }},
        {{"gbytes_per_s_share_percent", "of reading", "%"},
         [](const Row& r) { return ratio(100 * gbytes_per_s(r), r.read_gbytes_per_s); }},
        {{"peak_gflops", "peak", "GFLOP/s"}, [](const Row& r) -> Cell { return r.peak_gflops; }},
        {{"read_gbytes_per_s", "reading", "GB/s"}, [](const Row& r) -> Cell { return r.read_gbytes_per_s; }},
        {{"error_t1_percent", "err 1 s", "%"}, [](const Row& r) { return cell(r.report.error_percent); }},
        {{"bit_identical", "bits", ""},
         [](const Row& r) -> Cell {
             if (!r.is_bit_identical) return {};
             return std::string(*r.is_bit_identical ? "equal" : "differ");
         }},
        {{"state", "state", ""}, [](const Row& r) -> Cell { return r.report.state; }},
        {{"lost_percent", "lost", "%", 2}, [](const Row& r) -> Cell { return 100 * r.lost; }},
        {{"other_cores", "others", "cores", 2}, [](const Row& r) -> Cell { return r.others; }},
        {{"pinned_threads", "pinned", ""}, [](const Row& r) -> Cell { return std::int64_t{r.report.pinned_threads}; }},
        {{"omp_wait_policy", "OMP_WAIT_POLICY", ""}, [](const Row& r) -> Cell { return r.report.omp_wait_policy; }},
        {{"note", "note", ""}, [](const Row& r) -> Cell { return r.note(); }},
    };
}

/// Elements that a row steps in a millisecond.
double rate(const Row& row) {
    return static_cast<double>(row.report.run.elements) / row.ms_per_step;
}

std::optional<double> over(const Row& row, const Row& base) {
    if (row.mark == LoadMark::meaningless || base.mark == LoadMark::meaningless) return std::nullopt;
    return rate(row) / rate(base);
}

/// What a job's own repetitions say; what is relative to others comes later.
Row summarise(const Job& job, const std::vector<Report>& reports, double shortest_spin, int enough) {
    if (reports.empty()) throw Error(job.label() + ": no reports found, expected at least one");
    Row row;
    row.job = job;
    row.repetitions = reports.size();
    row.is_oversubscribed = is_oversubscribed(reports.front());
    const std::vector<double> lost = lost_shares(reports, shortest_spin);
    std::vector<double> others;
    for (const Report& report : reports) {
        others.push_back(report.load.others);
        row.peak_gflops = std::max(row.peak_gflops, report.peak_gflops);
        row.read_gbytes_per_s = std::max(row.read_gbytes_per_s, report.read_gbytes_per_s);
    }
    row.mark = judge(lost, enough);
    row.lost = median(lost);
    row.others = median(others);
    std::vector<const Report*> counted;
    for (std::size_t i = 0; i < reports.size(); ++i) {
        if (counts(row.mark, lost[i])) counted.push_back(&reports[i]);
    }
    std::ranges::sort(counted, {}, [](const Report* report) { return report->run.seconds_total; });
    std::vector<double> times;
    for (const Report* report : counted) {
        times.push_back(1e3 * report->run.seconds_total / static_cast<double>(report->run.steps));
    }
    const Summary summary = summarize(times);
    row.counted = counted.size();
    row.report = *counted[(counted.size() - 1) / 2];
    row.ms_per_step = summary.median;
    row.ms_minimum = summary.minimum;
    row.ms_maximum = summary.maximum;
    if (summary.count > 1) row.spread_percent = summary.spread_percent();
    return row;
}

}  // namespace

std::string Row::note() const {
    std::string text = to_string(mark);
    const auto add = [&text](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
    if (is_base_loaded) add("base loaded");
    if (is_oversubscribed) add("oversubscribed");
    if (report.pinned_threads > 0) add("pinned");
    return text;
}

std::vector<Row> make_rows(const Plan& plan, const Measurement& measurement, int repetitions) {
    const double spin = shortest_spin(measurement);
    std::vector<Row> of_jobs;
    for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
        of_jobs.push_back(summarise(plan.jobs[job], measurement[job], spin, enough_quiet(repetitions)));
    }
    std::vector<Row> rows;
    for (const Entry& entry : plan.entries) {
        Row row = of_jobs[entry.job];
        row.series = entry.series;
        row.speedup = over(row, of_jobs[entry.one_thread]);
        row.speedup_over_serial = over(row, of_jobs[entry.natural_order]);
        for (const std::size_t base : {entry.one_thread, entry.natural_order}) {
            row.is_base_loaded = row.is_base_loaded || (base != entry.job && of_jobs[base].mark == LoadMark::loaded);
        }
        if (!row.job.is_natural_order) {
            const std::string& expected = measurement[entry.same_blocks].front().state;
            row.is_bit_identical = std::ranges::all_of(
                measurement[entry.job], [&expected](const Report& report) { return report.state == expected; });
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

Table make_table(std::span<const Row> rows, std::span<const std::string_view> keys) {
    std::vector<Field> chosen;
    if (keys.empty()) {
        chosen = fields();
    } else {
        const std::vector<Field> all = fields();
        for (const std::string_view key : keys) {
            const auto found = std::ranges::find(all, key, [](const Field& field) { return field.column.key; });
            if (found == all.end()) throw Error("there is no column '" + std::string(key) + "'");
            chosen.push_back(*found);
        }
    }
    std::vector<Column> columns;
    for (const Field& field : chosen) columns.push_back(field.column);
    Table table(columns);
    for (const Row& row : rows) {
        std::vector<Cell> cells;
        for (const Field& field : chosen) cells.push_back(field.value(row));
        table.add_row(std::move(cells));
    }
    return table;
}

std::vector<SerialFraction> fit_serial_fractions(std::span<const Row> rows) {
    std::vector<SerialFraction> fractions;
    std::vector<std::vector<ThreadTime>> times;
    for (const Row& row : rows) {
        if (row.series != "strong" || row.job.scheduler == "serial") continue;
        Job one = row.job;
        one.threads = 1;
        auto found = std::ranges::find(fractions, one, &SerialFraction::job);
        if (found == fractions.end()) {
            fractions.push_back({one, row.report.run.elements, 0, std::nullopt});
            times.emplace_back();
            found = fractions.end() - 1;
        }
        if (row.is_oversubscribed || row.mark == LoadMark::meaningless) continue;
        times[static_cast<std::size_t>(found - fractions.begin())].push_back({row.report.run.threads, row.ms_per_step});
    }
    for (std::size_t i = 0; i < fractions.size(); ++i) {
        std::set<int> counts;
        for (const ThreadTime& time : times[i]) counts.insert(time.threads);
        fractions[i].counts = static_cast<int>(counts.size());
        fractions[i].fit = fit_amdahl(times[i]);
    }
    return fractions;
}

Table make_table(std::span<const SerialFraction> fractions) {
    Table table({{"problem", "problem"},
                 {"elements", "elements"},
                 {"scheduler", "scheduler"},
                 {"isa", "isa"},
                 {"scalar", "scalar"},
                 {"operator", "operator"},
                 {"scatter", "scatter"},
                 {"thread_counts", "counts"},
                 {"serial_fraction_percent", "serial", "%"},
                 {"standard_error_percent", "+-", "%", 2},
                 {"highest_speedup", "at most", "x"},
                 {"note", "note"}});
    for (const SerialFraction& entry : fractions) {
        const Job& job = entry.job;
        std::vector<Cell> cells{job.benchmark, entry.elements, job.scheduler, job.isa,
                                job.scalar,    job.matrix,     job.scatter,   std::int64_t{entry.counts}};
        if (entry.fit) {
            cells.insert(cells.end(), {100 * entry.fit->serial_fraction, 100 * entry.fit->standard_error,
                                       cell(entry.fit->highest_speedup()), std::string()});
        } else {
            cells.insert(cells.end(), {Cell(), Cell(), Cell(), std::string("too few thread counts, three are needed")});
        }
        table.add_row(std::move(cells));
    }
    return table;
}

}  // namespace lancet::experiments::scaling
