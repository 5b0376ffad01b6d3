#include "lancet/experiments/scheduler/tables.hpp"

#include "lancet/experiments/common/statistics.hpp"

namespace lancet::experiments::scheduler {

Table form_table(std::span<const Measured> rows) {
    Table table({{"elements", "elements"},
                 {"threads", "threads"},
                 {"extras", "beside it"},
                 {"form", "form"},
                 {"steps", "steps"},
                 {"p50_us", "p50", "us"},
                 {"p95_us", "p95", "us"},
                 {"p999_us", "p999", "us"},
                 {"overhead_percent", "overhead", "% of bare", 2},
                 {"overhead_lowest", "lowest", "%", 2},
                 {"overhead_highest", "highest", "%", 2},
                 {"to_serial", "step", "of serial"},
                 {"tasks", "tasks"},
                 {"us_per_task", "empty task", "us", 2},
                 {"bit_identical", "same bits"}});
    for (const Measured& row : rows) {
        const auto us = [&](double fraction) { return 1e6 * quantile(row.seconds, fraction); };
        // The step without a graph is what the others are compared with: on one thread that of no scheduler.
        const bool is_bare = row.tasks == 0 && (row.threads > 1 || row.form == "serial");
        const auto percent = [&](double ratio) { return is_bare ? Cell{} : Cell{100 * (ratio - 1)}; };
        table.add_row({row.elements, std::int64_t{row.threads}, std::string(to_string(row.extras)), row.form,
                       static_cast<std::int64_t>(row.seconds.size()), us(0.5), us(0.95), us(0.999),
                       percent(row.to_bare.middle), percent(row.to_bare.lowest), percent(row.to_bare.highest),
                       row.to_serial.middle, row.tasks > 0 ? Cell{std::int64_t{row.tasks}} : Cell{},
                       row.tasks > 0 ? Cell{1e6 * row.seconds_per_task} : Cell{},
                       std::string(row.bit_identical ? "yes" : "no")});
    }
    return table;
}

Table target_table(std::span<const Target> targets) {
    Table table({{"target", "target"},
                 {"elements", "elements"},
                 {"threads", "threads"},
                 {"form", "form"},
                 {"bound", "aim", "%"},
                 {"percent", "measured", "%", 2},
                 {"lowest", "lowest", "%", 2},
                 {"highest", "highest", "%", 2},
                 {"side_percent", "its work", "% of bare", 2},
                 {"graph_percent", "in no task", "% of bare", 2},
                 {"beside_percent", "beside the solve", "% of frames", 2},
                 {"at_most_percent", "can be hidden", "% of frames", 2},
                 {"met", "met"}});
    for (const Target& target : targets) {
        table.add_row(
            {target.what, target.elements, std::int64_t{target.threads}, target.form,
             std::string(target.is_at_most ? "<= " : ">= ") + format_number(target.bound, 2), target.percent.middle,
             target.percent.lowest, target.percent.highest, target.side ? Cell{target.side->middle} : Cell{},
             target.graph ? Cell{target.graph->middle} : Cell{}, target.beside ? Cell{target.beside->middle} : Cell{},
             target.at_most ? Cell{target.at_most->middle} : Cell{}, target.is_met()});
    }
    return table;
}

}  // namespace lancet::experiments::scheduler
