#include "lancet/experiments/scheduler/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::scheduler {
namespace {

Spread over_one(const Spread& ratio) {
    return {100 * (ratio.lowest - 1), 100 * (ratio.middle - 1), 100 * (ratio.highest - 1)};
}

Spread percent(const Spread& share) {
    return {100 * share.lowest, 100 * share.middle, 100 * share.highest};
}

std::string plain_name(const std::string& form) {
    if (form == "graph") return "the flow graph";
    if (form == "loops") return "phases of loops on oneTBB";
    if (form == "openmp-loops") return "loops on OpenMP";
    if (form == "openmp-tasks") return "tasks on OpenMP";
    if (form == "serial-tasks") return "tasks one after the other";
    return "the serial step";
}

std::string plain_name(Extras extras) {
    return extras == Extras::nothing ? "nothing beside the solve" : "with " + std::string(to_string(extras));
}

std::string join(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
}

/// Which form wins among rows of one bar, number of threads and extras.
std::string ranking(std::vector<const Measured*> rows) {
    std::ranges::sort(rows, {}, [](const Measured* row) { return row->to_serial.middle; });
    const Measured& best = *rows.front();
    std::vector<std::string> ties, slower;
    for (const Measured* row : rows) {
        if (row == &best) continue;
        const double behind = 100 * (row->to_serial.middle / best.to_serial.middle - 1);
        const std::string text = plain_name(row->form) + " (+" + format_number(behind, 2) + " %)";
        const bool is_tie = behind < resolution_percent || overlap(row->to_serial, best.to_serial);
        (is_tie ? ties : slower).push_back(text);
    }
    std::string text = std::to_string(best.elements) + " elements, threads: " + std::to_string(best.threads) + ", " +
                       plain_name(best.extras) + ": ";
    text += ties.empty() ? "fastest is " + plain_name(best.form)
                         : plain_name(best.form) + " first, but within the noise of " + join(ties);
    text += " (" + format_number(best.to_serial.middle, 3) + " of the serial step's time)";
    if (!slower.empty()) text += "; slower: " + join(slower);
    return text;
}

/// The lowest and the highest of a value in percent.
template <class Value>
std::string range(std::span<const Target> alike, const Value& value) {
    double lowest = value(alike.front()), highest = lowest;
    for (const Target& target : alike) {
        lowest = std::min(lowest, value(target));
        highest = std::max(highest, value(target));
    }
    return format_number(lowest, 2) + " to " + format_number(highest, 2) + " %";
}

/// How one aim went over all rows it is measured in.
std::string summary(std::span<const Target> alike) {
    std::array<int, 3> counts{};
    for (const Target& target : alike) {
        const std::string met = target.is_met();
        ++counts[met == "yes" ? 0 : met == "no" ? 1 : 2];
    }
    std::string text = alike.front().what + ", " + (alike.front().is_at_most ? "at most " : "at least ") +
                       format_number(alike.front().bound, 2) + " %: reached in " + std::to_string(counts[0]) +
                       " rows, missed in " + std::to_string(counts[1]) + ", undecided within the noise in " +
                       std::to_string(counts[2]) + "; measured " +
                       range(alike, [](const Target& target) { return target.percent.middle; });
    if (alike.front().beside && alike.front().at_most) {
        text += "; " + range(alike, [](const Target& target) { return target.beside->middle; }) +
                " ran beside the solve, and as that would use both threads itself, at most " +
                range(alike, [](const Target& target) { return target.at_most->middle; }) + " can be hidden";
    }
    return text;
}

}  // namespace

std::string Target::is_met() const {
    const auto meets = [this](double value) { return is_at_most ? value <= bound : value >= bound; };
    if (meets(percent.lowest) && meets(percent.highest)) return "yes";
    return meets(percent.lowest) || meets(percent.highest) ? "within noise" : "no";
}

std::vector<Target> targets(std::span<const Measured> rows) {
    std::vector<Target> found;
    for (const Measured& row : rows) {
        Target target{.elements = row.elements, .threads = row.threads, .form = row.form};
        if (row.tasks > 0 && row.threads == 1 && row.extras == Extras::nothing) {
            target.what = "nothing on: over the bare solve";
            target.bound = 1;
            target.percent = over_one(row.to_bare);
            found.push_back(target);
        }
        if (row.threads == 1 && row.extras == Extras::everything) {
            target.what = "everything on: over the bare solve";
            target.bound = 3;
            target.percent = over_one(row.to_bare);
            target.side = percent(row.side);
            target.graph = percent(row.graph);
            found.push_back(target);
        }
        if (row.threads == 2 && row.extras == Extras::frames) {
            target.what = "frames: hidden of their tasks' time";
            target.is_at_most = false;
            target.bound = 80;
            target.percent = percent(row.hidden);
            target.side = percent(row.side);
            target.beside = percent(row.beside);
            target.at_most = percent(row.hidden_at_most);
            found.push_back(target);
        }
    }
    std::ranges::stable_sort(found, {}, &Target::what);
    return found;
}

std::vector<std::string> verdict(std::span<const Measured> rows, std::span<const Target> targets) {
    std::vector<std::string> lines;
    for (auto begin = rows.begin(); begin != rows.end();) {
        const auto end =
            std::find_if(begin, rows.end(), [&](const Measured& row) { return row.elements != begin->elements; });
        std::vector<int> threads;
        for (auto row = begin; row != end; ++row) {
            if (std::ranges::find(threads, row->threads) == threads.end()) threads.push_back(row->threads);
        }
        for (const int count : threads) {
            for (const Extras extras : {Extras::nothing, Extras::everything}) {
                std::vector<const Measured*> alike;
                for (auto row = begin; row != end; ++row) {
                    if (row->threads == count && row->extras == extras) alike.push_back(&*row);
                }
                if (alike.size() > 1) lines.push_back(ranking(alike));
            }
        }
        begin = end;
    }
    for (auto begin = targets.begin(); begin != targets.end();) {
        const auto end = std::find_if(begin, targets.end(), [&](const Target& t) { return t.what != begin->what; });
        lines.push_back(summary({begin, end}));
        begin = end;
    }
    const auto differ = std::ranges::count_if(rows, [](const Measured& row) { return !row.bit_identical; });
    lines.push_back(differ == 0 ? "all forms end at the same positions, to the bit"
                                : std::to_string(differ) + " rows end at other positions than the serial step");
    return lines;
}

}  // namespace lancet::experiments::scheduler
