#include "lancet/mesh/generate/cylinder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

namespace {

void check(const Cylinder& rod) {
    const auto positive = [](double value, const char* what) {
        if (value > 0 && std::isfinite(value)) return;
        throw Error(std::string("cylinder: ") + what + ' ' + std::to_string(value) +
                    "; expected a positive finite length");
    };
    positive(rod.length, "length");
    positive(rod.radius, "radius");
    if (rod.cells_along < 1 || rod.cells_across < 1) {
        throw Error("cylinder: " + std::to_string(rod.cells_along) + " cells along and " +
                    std::to_string(rod.cells_across) + " across; expected at least 1");
    }
    if (rod.axis < 0 || rod.axis > 2) throw Error("cylinder: axis " + std::to_string(rod.axis) + "; expected 0, 1, 2");
    for (const double value : rod.origin) {
        if (!std::isfinite(value)) throw Error("cylinder: the origin is not finite");
    }
    constexpr double most = std::numeric_limits<std::int32_t>::max();
    const double across = rod.cells_across;
    // There are at least three times as many elements as nodes in a section, so elements overflow first or
    // together with nodes of long thin rods.
    if (18 * across * across * rod.cells_along > most ||
        (3 * across * (across + 1) + 1) * (rod.cells_along + 1.0) > most) {
        throw Error("cylinder: " + std::to_string(rod.cells_along) + " cells along and " +
                    std::to_string(rod.cells_across) + " across have more nodes or elements than 32-bit numbers count");
    }
}

/// Number of a node in a section: ring 0 is the centre, ring r has 6 r nodes and closes on itself.
std::int32_t section_node(std::int32_t ring, std::int32_t place) {
    return ring == 0 ? 0 : 3 * ring * (ring - 1) + 1 + place % (6 * ring);
}

std::vector<Triangle> section_triangles(int rings) {
    std::vector<Triangle> triangles;
    triangles.reserve(6 * static_cast<std::size_t>(rings) * static_cast<std::size_t>(rings));
    for (int ring = 1; ring <= rings; ++ring) {
        for (int sector = 0; sector < 6; ++sector) {
            const int outer = sector * ring;
            const int inner = sector * (ring - 1);
            for (int k = 0; k < ring; ++k) {
                triangles.push_back({section_node(ring - 1, inner + k), section_node(ring, outer + k),
                                     section_node(ring, outer + k + 1)});
                if (k + 1 == ring) continue;
                triangles.push_back({section_node(ring - 1, inner + k), section_node(ring, outer + k + 1),
                                     section_node(ring - 1, inner + k + 1)});
            }
        }
    }
    return triangles;
}

/// The three tetrahedra of a prism. Diagonals of its sides leave from the lower node number of the bottom, on which
/// the neighbour behind the side agrees.
void add_prism(Triangle bottom, std::int32_t layer, std::vector<Tetrahedron>& tetrahedra) {
    // Sorting by an odd permutation mirrors the prism; swapping two nodes of its tetrahedra mends that.
    const bool odd = ((bottom[0] > bottom[1]) != (bottom[1] > bottom[2])) != (bottom[0] > bottom[2]);
    std::sort(bottom.begin(), bottom.end());
    const auto [a, b, c] = bottom;
    std::array<Tetrahedron, 3> prism{
        {{a, b, c, c + layer}, {a, b, c + layer, b + layer}, {a, b + layer, c + layer, a + layer}}};
    for (Tetrahedron& t : prism) {
        if (odd) std::swap(t[0], t[1]);
        tetrahedra.push_back(t);
    }
}

}  // namespace

TetMesh cylinder(const Cylinder& rod) {
    check(rod);
    const int rings = rod.cells_across;
    const std::int32_t layer = section_node(rings + 1, 0);
    const auto along = static_cast<std::size_t>(rod.axis);
    const std::size_t first = (along + 1) % 3;
    const std::size_t second = (along + 2) % 3;

    TetMesh::Definition definition;
    auto& side = definition.node_sets["side"];
    definition.nodes.reserve(static_cast<std::size_t>(layer) * (static_cast<std::size_t>(rod.cells_along) + 1));
    for (int section = 0; section <= rod.cells_along; ++section) {
        for (int ring = 0; ring <= rings; ++ring) {
            for (int place = 0; place < std::max(1, 6 * ring); ++place) {
                const double radius = rod.radius * ring / rings;
                const double angle = ring == 0 ? 0.0 : std::numbers::pi * place / (3.0 * ring);
                Point x = rod.origin;
                x[first] += radius * std::cos(angle);
                x[second] += radius * std::sin(angle);
                x[along] += rod.length * section / rod.cells_along;
                if (ring == rings) side.push_back(static_cast<std::int32_t>(definition.nodes.size()));
                definition.nodes.push_back(x);
            }
        }
    }
    const std::vector<Triangle> triangles = section_triangles(rings);
    definition.tetrahedra.reserve(3 * triangles.size() * static_cast<std::size_t>(rod.cells_along));
    for (int section = 0; section < rod.cells_along; ++section) {
        for (const Triangle& triangle : triangles) {
            Triangle bottom = triangle;
            for (std::int32_t& node : bottom) node += section * layer;
            add_prism(bottom, layer, definition.tetrahedra);
        }
    }
    auto& start = definition.node_sets["start"];
    auto& end = definition.node_sets["end"];
    for (std::int32_t n = 0; n < layer; ++n) {
        start.push_back(n);
        end.push_back(rod.cells_along * layer + n);
    }
    return TetMesh(std::move(definition));
}

}  // namespace lancet::mesh
