#include "lancet/experiments/precision/diagram.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/gnuplot.hpp"
#include "lancet/experiments/precision/pareto.hpp"

namespace lancet::experiments::precision {
namespace {

struct Series {
    std::string name;
    std::vector<const Row*> rows;
};

std::vector<Series> series_of(std::span<const Row> rows) {
    std::vector<Series> all;
    for (const Row& row : rows) {
        const std::string& name = row.setting.series;
        auto found = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == name; });
        if (found == all.end()) found = all.insert(all.end(), {name, {}});
        found->rows.push_back(&row);
    }
    const auto is_earlier = [](const Series& a, const Series& b) { return a.name < b.name; };
    std::stable_sort(all.begin(), all.end(), is_earlier);
    for (Series& one : all) {
        std::stable_sort(one.rows.begin(), one.rows.end(),
                         [](const Row* a, const Row* b) { return a->seconds < b->seconds; });
    }
    return all;
}

double error_of(const Row& row, Shown shown) {
    return shown == Shown::judged ? row.errors.judged() : row.errors.quantity.value_or(0);
}

std::vector<const Row*> front_of(std::span<const Row> rows, Shown shown) {
    std::vector<TimeAndError> points;
    for (const Row& row : rows) points.push_back({row.seconds, error_of(row, shown)});
    const std::vector<bool> own = pareto_front(points);
    std::vector<const Row*> front;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (shown == Shown::judged ? rows[i].pareto : own[i]) front.push_back(&rows[i]);
    }
    std::stable_sort(front.begin(), front.end(), [](const Row* a, const Row* b) { return a->seconds < b->seconds; });
    return front;
}

/// One block for each series, then the front; blocks are what gnuplot calls index.
std::string data(const std::vector<Series>& series, std::span<const Row> rows, Shown shown) {
    std::ostringstream text;
    text.precision(17);
    const auto block = [&text, shown](const std::string& name, const std::vector<const Row*>& points) {
        text << "# " << name << "\n# seconds error_percent setting\n";
        for (const Row* row : points) {
            text << row->seconds << ' ' << error_of(*row, shown) << " \"" << row->setting.label() << "\"\n";
        }
        text << "\n\n";
    };
    for (const Series& one : series) block(one.name, one.rows);
    block("Pareto front", front_of(rows, shown));
    return text.str();
}

std::string script(const std::vector<Series>& series, Shown shown, const std::string& title, const std::string& name) {
    // Okabe and Ito's colours, told apart by every kind of sight; baselines have open symbols.
    const std::vector<std::string> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                           "#E69F00", "#56B4E9", "#8B5A2B", "#777777"};
    const std::vector<int> filled{7, 5, 9, 13, 11, 15}, open{6, 4, 8, 12, 10, 14};
    std::ostringstream text;
    text << "# Draws " << name << ".svg and " << name << ".png: gnuplot " << name << ".gp\n"
         << "if (!exists(\"part\")) part = ''\n"
         << "set logscale xy\nset grid xtics ytics mxtics mytics lt 1 lc rgb '#cccccc', lt 1 lc rgb '#eeeeee'\n"
         << "set xlabel 'wall-clock time (s)'\n"
         << "set ylabel 'error (%): "
         << (shown == Shown::judged ? "the larger of L2 norm and quantity of interest" : "quantity of interest")
         << "'\n"
         << "set format '%g'\nset title " << quoted(title) << " noenhanced\n"
         << "set key outside below Left reverse samplen 1 maxrows 5 noenhanced\nset pointsize 1.3\n";
    const auto plot = [&](const std::string& terminal, const std::string& ending) {
        text << "set terminal " << terminal << "\nset output " << quoted(name + ending) << ".part\nplot \\\n";
        for (std::size_t i = 0; i < series.size(); ++i) {
            const bool is_ours = series[i].name.starts_with("lancet");
            const int symbol = (is_ours ? filled : open)[i % filled.size()];
            text << "  " << quoted(name + ".dat") << " index " << i << " using 1:2 with points pt " << symbol
                 << " lc rgb '" << colours[i % colours.size()] << "' title " << quoted(series[i].name) << ", \\\n";
        }
        // A front of points is a staircase: between two of them the slower one's error is not yet had.
        text << "  " << quoted(name + ".dat") << " index " << series.size()
             << " using 1:2 with steps lw 1.5 lc rgb '#000000' notitle, \\\n"
             << "  " << quoted(name + ".dat") << " index " << series.size()
             << " using 1:2 with points pt 6 ps 2.2 lw 1.5 lc rgb '#000000' title 'Pareto front'\n"
             << "unset output\n";
    };
    plot("svg size 900,750 dynamic background rgb 'white' font 'sans,14'", ".svg");
    plot("pngcairo size 1350,1100 font 'sans,15'", ".png");
    return text.str();
}

}  // namespace

std::string draw(std::span<const Row> rows, Shown shown, const std::string& title, const std::filesystem::path& folder,
                 const std::string& name) {
    make_plot_folder(folder);
    const std::vector<Series> series = series_of(rows);
    write_file(folder / (name + ".dat"), data(series, rows, shown));
    write_file(folder / (name + ".gp"), script(series, shown, title, name));

    return run_gnuplot(folder, name, std::array<std::string, 2>{".svg", ".png"});
}

}  // namespace lancet::experiments::precision
