#include "lancet/mesh/inspect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace lancet::mesh {

namespace {

using Vector = std::array<double, 3>;

Vector difference(const Point& to, const Point& from, double scale) {
    return {scale * to[0] - scale * from[0], scale * to[1] - scale * from[1], scale * to[2] - scale * from[2]};
}

Vector cross(const Vector& u, const Vector& v) {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

double dot(const Vector& u, const Vector& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

double norm(const Vector& u) {
    return std::sqrt(dot(u, u));
}

bool is_finite(const Point& x) {
    return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

bool has_repeated_node(Tetrahedron t) {
    std::sort(t.begin(), t.end());
    return std::adjacent_find(t.begin(), t.end()) != t.end();
}

/// Elements grouped by their lowest node with a counting sort, so that only few have to be compared.
void find_duplicates(const std::vector<Tetrahedron>& tetrahedra, const std::vector<char>& usable,
                     std::size_t node_count, std::vector<std::int32_t>& duplicates) {
    struct Entry {
        Tetrahedron sorted;
        std::int32_t element;
    };
    std::vector<std::size_t> first(node_count + 1, 0);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        if (usable[t] != 0) ++first[*std::min_element(tetrahedra[t].begin(), tetrahedra[t].end()) + std::size_t{1}];
    }
    for (std::size_t n = 0; n < node_count; ++n) first[n + 1] += first[n];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    std::vector<Entry> entries(first.back());
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        if (usable[t] == 0) continue;
        Entry entry{tetrahedra[t], static_cast<std::int32_t>(t)};
        std::sort(entry.sorted.begin(), entry.sorted.end());
        entries[next[entry.sorted[0]]++] = entry;
    }
    for (std::size_t n = 0; n < node_count; ++n) {
        const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(first[n]);
        const auto end = entries.begin() + static_cast<std::ptrdiff_t>(first[n + 1]);
        std::sort(begin, end, [](const Entry& left, const Entry& right) {
            return left.sorted != right.sorted ? left.sorted < right.sorted : left.element < right.element;
        });
        for (auto entry = begin; entry != end; ++entry) {
            if (entry != begin && entry->sorted == (entry - 1)->sorted) duplicates.push_back(entry->element);
        }
    }
    std::sort(duplicates.begin(), duplicates.end());
}

void check_sizes_and_sets(const TetMesh::Definition& definition, std::vector<std::string>& other) {
    const auto& [nodes, tetrahedra, regions, node_sets, region_names] = definition;
    if (!regions.empty() && regions.size() != tetrahedra.size()) {
        other.push_back(std::to_string(regions.size()) + " region numbers for " + std::to_string(tetrahedra.size()) +
                        " elements");
    }
    for (const auto& [name, members] : node_sets) {
        for (const std::int32_t node : members) {
            if (node >= 0 && static_cast<std::size_t>(node) < nodes.size()) continue;
            other.push_back("node set '" + name + "' names node " + std::to_string(node) + " of " +
                            std::to_string(nodes.size()));
            break;
        }
    }
}

}  // namespace

Shape shape(const Point& a, const Point& b, const Point& c, const Point& d) {
    double largest = 0;
    for (const Point* x : {&a, &b, &c, &d}) {
        for (const double value : *x) largest = std::max(largest, std::abs(value));
    }
    // Coordinates of the order of one, by a power of two: neither overflow nor a rounding is added.
    int exponent = 0;
    const double magnitude = std::frexp(largest, &exponent);
    exponent = std::clamp(exponent, -1000, 1000);
    const double scale = std::ldexp(1.0, -exponent);
    const Vector e1 = difference(b, a, scale);
    const Vector e2 = difference(c, a, scale);
    const Vector e3 = difference(d, a, scale);
    const Vector n3 = cross(e1, e2);
    const Vector n1 = cross(e2, e3);
    const Vector n2 = cross(e3, e1);
    const Vector n0{n1[0] + n2[0] + n3[0], n1[1] + n2[1] + n3[1], n1[2] + n2[2] + n3[2]};
    const double areas = norm(n0) + norm(n1) + norm(n2) + norm(n3);
    const double determinant = dot(e3, n3);
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const double bound = 4 * epsilon * (magnitude * areas + norm(e1) * norm(e2) * norm(e3));
    const double volume = signed_volume(a, b, c, d);
    if (!(std::abs(determinant) > bound) || !std::isnormal(volume)) return Shape::flat;
    return determinant > 0 ? Shape::positive : Shape::inverted;
}

bool Inspection::clean() const {
    return non_finite_nodes.empty() && out_of_range_elements.empty() && repeated_node_elements.empty() &&
           inverted_elements.empty() && flat_elements.empty() && duplicate_elements.empty() && isolated_nodes.empty() &&
           other.empty();
}

Inspection inspect(const TetMesh::Definition& definition) {
    const auto& nodes = definition.nodes;
    const auto& tetrahedra = definition.tetrahedra;
    Inspection result;
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (nodes.size() > most || tetrahedra.size() > most) {
        result.other.push_back("more nodes or elements than 32-bit numbers count: " + std::to_string(nodes.size()) +
                               " nodes, " + std::to_string(tetrahedra.size()) + " elements");
        return result;
    }
    check_sizes_and_sets(definition, result.other);

    std::vector<char> finite(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        finite[n] = is_finite(nodes[n]) ? 1 : 0;
        if (finite[n] == 0) result.non_finite_nodes.push_back(static_cast<std::int32_t>(n));
    }

    std::vector<char> used(nodes.size(), 0);
    std::vector<char> usable(tetrahedra.size(), 0);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        const Tetrahedron& nodes_of = tetrahedra[t];
        const auto number = static_cast<std::int32_t>(t);
        bool in_range = true;
        bool all_finite = true;
        for (const std::int32_t node : nodes_of) {
            if (node < 0 || static_cast<std::size_t>(node) >= nodes.size()) {
                in_range = false;
                continue;
            }
            used[node] = 1;
            all_finite = all_finite && finite[node] != 0;
        }
        if (!in_range) {
            result.out_of_range_elements.push_back(number);
        } else if (has_repeated_node(nodes_of)) {
            result.repeated_node_elements.push_back(number);
        } else {
            usable[t] = 1;
            if (!all_finite) continue;
            const Point& a = nodes[nodes_of[0]];
            const Point& b = nodes[nodes_of[1]];
            const Point& c = nodes[nodes_of[2]];
            const Point& d = nodes[nodes_of[3]];
            const Shape kind = shape(a, b, c, d);
            if (kind == Shape::positive) continue;
            (kind == Shape::flat ? result.flat_elements : result.inverted_elements).push_back(number);
            const double volume = signed_volume(a, b, c, d);
            if (result.worst_element < 0 || volume < result.worst_volume) {
                result.worst_volume = volume;
                result.worst_element = number;
            }
        }
    }
    find_duplicates(tetrahedra, usable, nodes.size(), result.duplicate_elements);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (used[n] == 0) result.isolated_nodes.push_back(static_cast<std::int32_t>(n));
    }
    return result;
}

std::string describe(const Inspection& inspection, const TetMesh::Definition& definition) {
    std::ostringstream text;
    const char* separator = "";
    const auto add_elements = [&](const std::vector<std::int32_t>& which, const char* what) {
        if (which.empty()) return;
        const Tetrahedron& t = definition.tetrahedra[which.front()];
        text << separator << which.size() << " of " << definition.tetrahedra.size() << " elements " << what
             << " (first: element " << which.front() << " with nodes " << t[0] << ' ' << t[1] << ' ' << t[2] << ' '
             << t[3] << ')';
        separator = "; ";
    };
    const auto add_nodes = [&](const std::vector<std::int32_t>& which, const char* what) {
        if (which.empty()) return;
        text << separator << which.size() << " of " << definition.nodes.size() << " nodes " << what << " (first: node "
             << which.front() << ')';
        separator = "; ";
    };
    for (const std::string& line : inspection.other) {
        text << separator << line;
        separator = "; ";
    }
    add_nodes(inspection.non_finite_nodes, "with a coordinate that is not finite");
    add_elements(inspection.out_of_range_elements, "with a node number out of range");
    add_elements(inspection.repeated_node_elements, "with a repeated node");
    add_elements(inspection.inverted_elements, "inverted");
    add_elements(inspection.flat_elements, "flat");
    if (inspection.worst_element >= 0) {
        text << separator << "worst volume " << inspection.worst_volume << " at element " << inspection.worst_element;
    }
    add_elements(inspection.duplicate_elements, "repeat an earlier one");
    add_nodes(inspection.isolated_nodes, "not used by any element");
    return text.str();
}

}  // namespace lancet::mesh
