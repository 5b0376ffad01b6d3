#include "lancet/experiments/scaling/pictures.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
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

/// Okabe and Ito's colours, told apart by every kind of sight.
std::string colour(std::size_t index) {
    constexpr std::array<const char*, 8> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#8B5A2B", "#777777"};
    return colours[index % colours.size()];
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

/// "1,2,8"
std::string thread_counts(const Picture& picture) {
    std::set<int> counts;
    for (const auto& [title, points] : picture.curves) {
        for (const auto& [threads, value] : points) counts.insert(threads);
    }
    std::string text;
    for (const int count : counts) text += (text.empty() ? "" : ",") + std::to_string(count);
    return text;
}

std::string script(const Picture& picture) {
    const std::string& name = picture.name;
    std::ostringstream text;
    text << "# Draws " << name << ".svg and " << name << ".png: gnuplot " << name << ".gp\n"
         << "if (!exists(\"part\")) part = ''\n"
         << "set grid\nset xlabel 'threads'\nset ylabel " << quoted(picture.ylabel) << "\nset title "
         << quoted(picture.title) << " noenhanced\nset xtics (" << thread_counts(picture)
         << ")\nset xrange [0.5:*]\nset yrange [0:"
         << (picture.top > 0 ? std::to_string(picture.top) : std::string("*"))
         << "]\nset key outside right top Left reverse noenhanced\nset pointsize 1.3\n";
    const auto plot = [&](const std::string& terminal, const std::string& ending) {
        text << "set terminal " << terminal << "\nset output " << quoted(name + ending) << ".part\nplot ";
        std::size_t index = 0;
        for (const auto& [title, points] : picture.curves) {
            // Of the thesis single points are known, and nothing of what is between them.
            const bool is_thesis = title.ends_with("thesis");
            text << (index > 0 ? ", \\\n  " : "") << quoted(name + ".dat") << " index " << index << " using 1:2 with "
                 << (is_thesis ? "points pt 3 ps 2 lc rgb '#000000'"
                               : "linespoints lw 2 lc rgb " + quoted(colour(index)))
                 << " title " << quoted(title);
            ++index;
        }
        if (picture.has_ideal) text << ", \\\n  x with lines dt 2 lc rgb '#777777' title 'ideal'";
        text << "\nunset output\n";
    };
    plot("svg size 1000,600 dynamic background rgb 'white' font 'sans,14'", ".svg");
    plot("pngcairo size 1500,900 font 'sans,15'", ".png");
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
                                       if (row.mark == LoadMark::meaningless) return std::nullopt;
                                       return 100 * row.report.run.seconds_solve / row.report.run.seconds_total;
                                   })}};
    const bool has_thesis = std::ranges::find(rows, "thesis", &Row::series) != rows.end();
    std::string complaint;
    for (Picture& picture : pictures) {
        // Where the load has left nothing else to show, the thesis' points are drawn alone.
        if (has_thesis && picture.name == "figure-5-8") add_thesis(picture, true);
        if (has_thesis && picture.name == "figure-5-9") add_thesis(picture, false);
        if (picture.curves.empty()) continue;
        write_file(folder / (picture.name + ".dat"), data(picture));
        write_file(folder / (picture.name + ".gp"), script(picture));
        const std::string failed = run_gnuplot(folder, picture.name, std::array<std::string, 2>{".svg", ".png"});
        if (complaint.empty()) complaint = failed;
    }
    return complaint;
}

}  // namespace lancet::experiments::scaling
