#include "lancet/experiments/cutting/row.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::cutting {
namespace {

struct Entry {
    Column column;
    std::function<Cell(const Row&)> cell;
};

Cell cell(const std::string& text) {
    return text.empty() ? Cell() : Cell(text);
}
Cell cell(std::int64_t count) {
    return count;
}
template <class Value>
Cell cell(const std::optional<Value>& value) {
    return value ? Cell(*value) : Cell();
}

template <class Value>
Entry entry(Value Row::*member, Column column) {
    return {std::move(column), [member](const Row& row) { return cell(row.*member); }};
}

const std::vector<Entry>& entries() {
    static const std::vector<Entry> all{
        entry(&Row::scene, {"scene", "scene"}),
        entry(&Row::variant, {"variant", "body"}),
        entry(&Row::model, {"model", "model"}),
        entry(&Row::enrichment, {"enrichment", "basis"}),
        entry(&Row::matrix, {"operator", "operator"}),
        entry(&Row::scalar, {"scalar", "scalar"}),
        entry(&Row::frame, {"frame", "frame"}),
        entry(&Row::time, {"time_s", "time", "s"}),
        entry(&Row::elements, {"elements", "elements"}),
        entry(&Row::nodes, {"nodes", "nodes"}),
        entry(&Row::cut_elements, {"cut_elements", "cut"}),
        entry(&Row::parts, {"parts", "parts"}),
        entry(&Row::added_dofs, {"added_dofs", "added DOFs"}),
        entry(&Row::ms_geometry, {"ms_geometry", "geometry", "ms"}),
        entry(&Row::ms_topology, {"ms_topology", "topology", "ms"}),
        entry(&Row::ms_update, {"ms_update", "update", "ms"}),
        entry(&Row::ms_step, {"ms_step", "step", "ms"}),
        entry(&Row::ms_solve, {"ms_solve", "solve", "ms"}),
        entry(&Row::step_ratio, {"step_ratio", "step", "of uncut"}),
        entry(&Row::step_ratio_of_cut_element, {"step_ratio_of_cut_element", "cut element", "of uncut"}),
        entry(&Row::cut_lane_ratio, {"cut_lane_ratio", "cut element", "of uncut"}),
        entry(&Row::force_ratio, {"force_ratio", "force", "of uncut"}),
        entry(&Row::product_ratio, {"product_ratio", "product", "of uncut"}),
        entry(&Row::edge_ratio, {"edge_ratio", "edges", "of uncut"}),
        entry(&Row::cg_iterations, {"cg_iterations", "CG iterations"}),
        entry(&Row::error_l2, {"error_l2", "L2 error"}),
        entry(&Row::error_energy, {"error_energy", "energy error"}),
        entry(&Row::order_l2, {"order_l2", "L2 order", "", 2}),
        entry(&Row::order_energy, {"order_energy", "energy order", "", 2}),
        entry(&Row::unknowns, {"unknowns", "unknowns"}),
        entry(&Row::noise_percent, {"noise_percent", "noise", "%", 2}),
        entry(&Row::note, {"note", "note"}),
    };
    return all;
}

Table make_table(std::span<const Row> rows, const std::vector<const Entry*>& chosen) {
    std::vector<Column> columns;
    for (const Entry* one : chosen) columns.push_back(one->column);
    Table table(std::move(columns));
    for (const Row& row : rows) {
        std::vector<Cell> cells;
        for (const Entry* one : chosen) cells.push_back(one->cell(row));
        table.add_row(std::move(cells));
    }
    return table;
}

}  // namespace

std::string noise_note(std::optional<double> noise_percent) {
    return noise_percent && *noise_percent > noisy_percent ? "noisy" : "";
}

Table make_table(std::span<const Row> rows) {
    std::vector<const Entry*> chosen;
    for (const Entry& one : entries()) chosen.push_back(&one);
    return make_table(rows, chosen);
}

Table make_table(std::span<const Row> rows, std::span<const std::string_view> keys) {
    std::vector<const Entry*> chosen;
    for (const std::string_view key : keys) {
        const auto found = std::ranges::find_if(entries(), [&](const Entry& one) { return one.column.key == key; });
        if (found == entries().end()) throw Error("there is no result '" + std::string(key) + "'");
        chosen.push_back(&*found);
    }
    return make_table(rows, chosen);
}

}  // namespace lancet::experiments::cutting
