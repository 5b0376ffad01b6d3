#include "lancet/experiments/collision/row.hpp"

namespace lancet::experiments::collision {
namespace {

template <class Value>
Cell cell(const std::optional<Value>& value) {
    return value ? Cell(*value) : Cell();
}

}  // namespace

Table make_table(std::span<const Row> rows) {
    Table table({{"scene", "scene"},
                 {"primitives", "primitives"},
                 {"queries", "queries"},
                 {"kind", "broad phase"},
                 {"ms_build", "build", "ms"},
                 {"ms_refit", "refit", "ms"},
                 {"ms_query", "query", "ms"},
                 {"times_brute_force", "refit+query", "x brute"},
                 {"ms_contacts", "contacts", "ms"},
                 {"rebuilds_percent", "rebuilt", "%"},
                 {"candidates", "candidates"},
                 {"contacts", "contacts"},
                 {"unresolved", "unresolved"},
                 {"megabytes", "memory", "MB"},
                 {"noise_percent", "noise", "%", 2},
                 {"note", "note"}});
    for (const Row& row : rows) {
        table.add_row({row.scene, row.primitives, row.queries, row.kind, cell(row.ms_build), cell(row.ms_refit),
                       cell(row.ms_query), cell(row.times_brute_force), cell(row.ms_contacts),
                       row.rebuilds ? Cell(100 * *row.rebuilds) : Cell(), cell(row.candidates), cell(row.contacts),
                       cell(row.unresolved), cell(row.megabytes), cell(row.noise_percent),
                       row.note.empty() ? Cell() : Cell(row.note)});
    }
    return table;
}

}  // namespace lancet::experiments::collision
