#include "lancet/mesh/repair.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "lancet/mesh/inspect.hpp"

namespace lancet::mesh {

namespace {

/// Maps between old and new numbers after dropping the marked ones.
void number(const std::vector<char>& dropped, std::vector<std::int32_t>& old_of_new,
            std::vector<std::int32_t>& new_of_old) {
    new_of_old.assign(dropped.size(), -1);
    for (std::size_t old = 0; old < dropped.size(); ++old) {
        if (dropped[old] != 0) continue;
        new_of_old[old] = static_cast<std::int32_t>(old_of_new.size());
        old_of_new.push_back(static_cast<std::int32_t>(old));
    }
}

template <typename Value>
void keep(std::vector<Value>& values, const std::vector<std::int32_t>& old_of_new) {
    for (std::size_t n = 0; n < old_of_new.size(); ++n) values[n] = values[static_cast<std::size_t>(old_of_new[n])];
    values.resize(old_of_new.size());
}

/// Marks the elements and says so in a note.
void drop(const std::vector<std::int32_t>& which, const std::string& what, std::vector<char>& dropped,
          std::vector<std::string>& notes) {
    if (which.empty()) return;
    for (const std::int32_t element : which) dropped[element] = 1;
    notes.push_back("dropped " + std::to_string(which.size()) + ' ' + what + " (first: element " +
                    std::to_string(which.front()) + ")");
}

void turn(const Inspection& found, TetMesh::Definition& definition, std::vector<std::string>& notes) {
    if (found.inverted_elements.empty()) return;
    double worst = 0;
    for (const std::int32_t element : found.inverted_elements) {
        Tetrahedron& t = definition.tetrahedra[element];
        const auto& x = definition.nodes;
        worst = std::min(worst, signed_volume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]));
        std::swap(t[2], t[3]);
    }
    std::ostringstream note;
    note << "turned " << found.inverted_elements.size() << " of " << definition.tetrahedra.size()
         << " elements that were inverted (first: element " << found.inverted_elements.front() << ", lowest volume "
         << worst << ")";
    notes.push_back(note.str());
}

/// Nodes that none of the kept elements uses.
std::vector<char> find_isolated(const TetMesh::Definition& definition, const std::vector<char>& dropped_elements) {
    std::vector<char> isolated(definition.nodes.size(), 1);
    for (std::size_t t = 0; t < definition.tetrahedra.size(); ++t) {
        if (dropped_elements[t] != 0) continue;
        for (const std::int32_t node : definition.tetrahedra[t]) {
            if (node >= 0 && static_cast<std::size_t>(node) < isolated.size()) isolated[node] = 0;
        }
    }
    return isolated;
}

void renumber_nodes(Repaired& result) {
    TetMesh::Definition& definition = result.definition;
    const auto renumbered = [&](std::int32_t node) {
        // What is out of range stays so, for TetMesh to report.
        return node >= 0 && static_cast<std::size_t>(node) < result.new_of_node.size() ? result.new_of_node[node]
                                                                                       : node;
    };
    keep(definition.nodes, result.node_of_new);
    for (Tetrahedron& t : definition.tetrahedra) {
        for (std::int32_t& node : t) node = renumbered(node);
    }
    for (auto& [name, members] : definition.node_sets) {
        const std::size_t before = members.size();
        for (std::int32_t& node : members) node = renumbered(node);
        members.erase(std::remove(members.begin(), members.end(), -1), members.end());
        if (members.size() != before) {
            result.notes.push_back("node set '" + name + "' lost " + std::to_string(before - members.size()) +
                                   " entries that no element uses");
        }
    }
}

}  // namespace

Repaired repair(TetMesh::Definition definition, const RepairOptions& options) {
    Repaired result;
    result.definition = std::move(definition);
    TetMesh::Definition& mesh = result.definition;
    const Inspection found = inspect(mesh);

    if (options.turn_inverted) turn(found, mesh, result.notes);
    std::vector<char> dropped(mesh.tetrahedra.size(), 0);
    if (options.drop_flat) {
        drop(found.flat_elements, "flat elements", dropped, result.notes);
        drop(found.repeated_node_elements, "elements with a repeated node", dropped, result.notes);
    }
    if (options.drop_duplicates) {
        drop(found.duplicate_elements, "elements that repeat an earlier one", dropped, result.notes);
    }
    std::vector<char> isolated(mesh.nodes.size(), 0);
    if (options.drop_isolated_nodes) isolated = find_isolated(mesh, dropped);

    number(dropped, result.element_of_new, result.new_of_element);
    number(isolated, result.node_of_new, result.new_of_node);
    if (mesh.regions.size() == mesh.tetrahedra.size()) keep(mesh.regions, result.element_of_new);
    keep(mesh.tetrahedra, result.element_of_new);
    if (result.node_of_new.size() != mesh.nodes.size()) {
        const auto first = std::find(isolated.begin(), isolated.end(), 1) - isolated.begin();
        result.notes.push_back("dropped " + std::to_string(mesh.nodes.size() - result.node_of_new.size()) + " of " +
                               std::to_string(mesh.nodes.size()) + " nodes that no element uses (first: node " +
                               std::to_string(first) + ")");
        renumber_nodes(result);
    }
    return result;
}

}  // namespace lancet::mesh
