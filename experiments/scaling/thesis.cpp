#include "lancet/experiments/scaling/thesis.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace lancet::experiments::scaling {
namespace {

/// A line of table 5.1.
struct Line {
    std::string benchmark, program;
    std::map<int, double> seconds;  ///< by cores
    std::optional<double> speedup;
    std::string note;
};

std::string program_of(const Job& job) {
    return job.is_natural_order ? "natural order" : job.scheduler;
}

void add_note(std::string& notes, const std::string& note) {
    if (!note.empty() && notes.find(note) == std::string::npos) notes += (notes.empty() ? "" : "; ") + note;
}

std::vector<Line> lines_of(std::span<const Row> rows) {
    std::vector<Line> lines;
    const auto line = [&lines](const std::string& benchmark, const std::string& program) -> Line& {
        const auto found = std::ranges::find_if(lines, [&](const Line& candidate) {
            return candidate.benchmark == benchmark && candidate.program == program;
        });
        if (found != lines.end()) return *found;
        lines.push_back({.benchmark = benchmark, .program = program, .seconds = {}, .speedup = {}, .note = {}});
        return lines.back();
    };
    std::set<std::string> benchmarks;
    for (const Row& row : rows) {
        if (row.series != "thesis") continue;
        if (benchmarks.insert(row.job.benchmark).second) {
            for (const ThesisRun& run : thesis_runs()) {
                if (run.benchmark != row.job.benchmark) continue;
                Line& own = line(run.benchmark, "thesis");
                own.seconds[run.cores] = run.seconds;
                if (run.speedup) own.speedup = std::max(own.speedup.value_or(0), *run.speedup);
                add_note(own.note, run.note);
            }
        }
        Line& measured = line(row.job.benchmark, program_of(row.job));
        measured.seconds[row.report.run.threads] = row.seconds();
        if (row.speedup_over_serial) {
            measured.speedup = std::max(measured.speedup.value_or(0), *row.speedup_over_serial);
        }
        const std::string note = row.note();
        if (!note.empty()) add_note(measured.note, std::to_string(row.report.run.threads) + ": " + note);
    }
    return lines;
}

Cell cell(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

}  // namespace

const std::vector<ThesisRun>& thesis_runs() {
    static const std::vector<ThesisRun> runs{{.benchmark = "bar",
                                              .cores = 1,
                                              .seconds = 36.4,
                                              .speedup = 1,
                                              .cg_share_percent = 88,
                                              .note = "cores of 2006"},
                                             {.benchmark = "bar",
                                              .cores = 8,
                                              .seconds = 36.4 / 6.5,
                                              .speedup = 6.5,
                                              .cg_share_percent = {},
                                              .note = "8: from its speed-up"},
                                             {.benchmark = "organ",
                                              .cores = 1,
                                              .seconds = 7,
                                              .speedup = {},
                                              .cg_share_percent = {},
                                              .note = "another body; steps and number of cores not known here"}};
    return runs;
}

Table make_table_5_1(std::span<const Row> rows) {
    const std::vector<Line> lines = lines_of(rows);
    std::set<int> counts;
    for (const Line& line : lines) {
        for (const auto& [cores, seconds] : line.seconds) counts.insert(cores);
    }
    std::vector<Column> columns{{"problem", "problem"}, {"program", "program"}};
    for (const int count : counts) {
        const std::string text = std::to_string(count);
        columns.push_back({.key = "seconds_" + text, .title = text + (count == 1 ? " core" : " cores"), .unit = "s"});
    }
    columns.push_back({.key = "highest_speedup", .title = "speed-up", .unit = "x"});
    columns.push_back({.key = "note", .title = "note", .unit = ""});
    Table table(columns);
    for (const Line& line : lines) {
        std::vector<Cell> cells{line.benchmark, line.program};
        for (const int count : counts) {
            const auto found = line.seconds.find(count);
            cells.emplace_back();
            if (found != line.seconds.end()) cells.back() = found->second;
        }
        cells.push_back(cell(line.speedup));
        cells.emplace_back(line.note);
        table.add_row(std::move(cells));
    }
    return table;
}

Table make_figures_5_8_and_5_9(std::span<const Row> rows) {
    Table table({{"problem", "problem"},
                 {"program", "program"},
                 {"cores", "cores"},
                 {"seconds", "whole run", "s"},
                 {"speedup", "speed-up", "x"},
                 {"cg_share_percent", "CG", "%"},
                 {"error_t1_percent", "err 1 s", "%"},
                 {"note", "note"}});
    std::set<std::string> benchmarks;
    for (const Row& row : rows) {
        if (row.series != "thesis") continue;
        if (benchmarks.insert(row.job.benchmark).second) {
            for (const ThesisRun& run : thesis_runs()) {
                if (run.benchmark != row.job.benchmark) continue;
                table.add_row({run.benchmark, std::string("thesis"), std::int64_t{run.cores}, run.seconds,
                               cell(run.speedup), cell(run.cg_share_percent), Cell(), run.note});
            }
        }
        const bar::WorkerReport& run = row.report.run;
        table.add_row({row.job.benchmark, program_of(row.job), std::int64_t{run.threads}, row.seconds(),
                       cell(row.speedup_over_serial), 100 * run.seconds_solve / run.seconds_total,
                       cell(row.report.error_percent), row.note()});
    }
    return table;
}

}  // namespace lancet::experiments::scaling
