#include "lancet/experiments/scaling/pictures.hpp"

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/gnuplot.hpp"
#include "lancet/experiments/scaling/thesis.hpp"

namespace lancet::experiments::scaling {
namespace {

using Curve = std::vector<std::pair<int, double>>;  // threads and value
using Curves = std::map<std::string, Curve>;        // by title

struct Picture {
    std::string name, title, ylabel;
    bool has_ideal = false;  ///< the line speed-up = threads
    double top = 0;          ///< of the axis; 0: chosen
    Curves curves{};
};

/// The curves of a series; rows in natural order, which have one thread and no scheduler, are the base and no curve.
Curves curves_of(std::span<const Row> rows, const std::string& series,
                 const std::function<std::optional<double>(const Row&)>& value) {
    Curves curves;
    for (const Row& row : rows) {
        if (row.series != series || row.job.scheduler == "serial") continue;
        const std::optional<double> found = value(row);
        if (!found) continue;
        const std::string size = series == "weak" ? "" : " " + std::to_string(row.report.run.elements);
        std::string title = row.job.benchmark + size + " " + row.job.scheduler;
        if (row.is_oversubscribed) title += " oversubscribed";
        curves[title].emplace_back(row.report.run.threads, *found);
    }
    return curves;
}

void add_thesis(Picture& picture, bool is_speedup) {
    for (const ThesisRun& run : thesis_runs()) {
        const std::optional<double>& value = is_speedup ? run.speedup : run.cg_share_percent;
        if (value) picture.curves[run.benchmark + ", thesis"].emplace_back(run.cores, *value);
    }
}

std::string data(const Picture& picture) {
    std::ostringstream text;
    text.precision(17);
    for (const auto& [title, points] : picture.curves) {
        text << "# " << title << "\n# threads value\n";
        for (const auto& [threads, value] : points) text << threads << ' ' << value << '\n';
        text << "\n\n";
    }
    return text.str();
}

std::string script(const Picture& picture) {
    const std::string& name = picture.name;
    std::ostringstream text;
    text << "# Draws " << name << ".svg and " << name << ".png: gnuplot " << name << ".gp\n"
         << "if (!exists(\"part\")) part = ''\n"
         << "set grid\nset xlabel 'threads'\nset ylabel " << quoted(picture.ylabel) << "\nset title "
         << quoted(picture.title) << " noenhanced\nset xtics 1\nset xrange [0.5:*]\nset yrange [0:"
         << (picture.top > 0 ? std::to_string(picture.top) : std::string("*"))
         << "]\nset key outside below Left reverse noenhanced\nset pointsize 1.3\n";
    const auto plot = [&](const std::string& terminal, const std::string& ending) {
        text << "set terminal " << terminal << "\nset output " << quoted(name + ending) << ".part\nplot ";
        std::size_t index = 0;
        for (const auto& [title, points] : picture.curves) {
            text << (index > 0 ? ", \\\n  " : "") << quoted(name + ".dat") << " index " << index
                 << " using 1:2 with linespoints lw 2 title " << quoted(title);
            ++index;
        }
        if (picture.has_ideal) text << ", \\\n  x with lines dt 2 lc rgb '#777777' title 'ideal'";
        text << "\nunset output\n";
    };
    plot("svg size 800,650 dynamic background rgb 'white' font 'sans,14'", ".svg");
    plot("pngcairo size 1200,975 font 'sans,15'", ".png");
    return text.str();
}

}  // namespace

std::string draw(std::span<const Row> rows, const std::filesystem::path& folder) {
    make_plot_folder(folder);
    const auto speedup = [](const Row& row) { return row.speedup_over_serial; };
    std::vector<Picture> pictures{{.name = "speedup",
                                   .title = "Strong scaling",
                                   .ylabel = "speed-up over the serial run in natural order",
                                   .has_ideal = true,
                                   .curves = curves_of(rows, "strong", speedup)},
                                  {.name = "efficiency",
                                   .title = "Weak scaling: as many elements for each thread",
                                   .ylabel = "efficiency against the serial run in natural order (%)",
                                   .curves = curves_of(rows, "weak",
                                                       [](const Row& row) -> std::optional<double> {
                                                           if (!row.speedup_over_serial) return std::nullopt;
                                                           return 100 * *row.speedup_over_serial /
                                                                  row.report.run.threads;
                                                       })},
                                  {.name = "figure-5-8",
                                   .title = "Speed-up in the original setting",
                                   .ylabel = "speed-up over the serial run in natural order",
                                   .has_ideal = true,
                                   .curves = curves_of(rows, "thesis", speedup)},
                                  {.name = "figure-5-9",
                                   .title = "Part of the time in conjugate gradients, original setting",
                                   .ylabel = "conjugate gradients (% of the time)",
                                   .top = 100,
                                   .curves = curves_of(rows, "thesis", [](const Row& row) -> std::optional<double> {
                                       return 100 * row.report.run.seconds_solve / row.report.run.seconds_total;
                                   })}};
    std::string complaint;
    for (Picture& picture : pictures) {
        if (picture.curves.empty()) continue;
        if (picture.name == "figure-5-8") add_thesis(picture, true);
        if (picture.name == "figure-5-9") add_thesis(picture, false);
        write_file(folder / (picture.name + ".dat"), data(picture));
        write_file(folder / (picture.name + ".gp"), script(picture));
        const std::string failed = run_gnuplot(folder, picture.name, std::array<std::string, 2>{".svg", ".png"});
        if (complaint.empty()) complaint = failed;
    }
    return complaint;
}

}  // namespace lancet::experiments::scaling
