#include "lancet/mesh/generate/box.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/cell_tetrahedra.hpp"

namespace lancet::mesh {

namespace {

void check(const Box& box) {
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    std::int64_t nodes = 1;
    std::int64_t elements = box.split == Split::five ? 5 : 6;
    constexpr const char* axes = "xyz";
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string where = std::string(" along ") + axes[axis];
        if (box.cells[axis] < 1) {
            throw Error("box: " + std::to_string(box.cells[axis]) + " cells" + where + "; expected at least 1");
        }
        if (!(box.size[axis] > 0) || !std::isfinite(box.size[axis])) {
            throw Error("box: size " + std::to_string(box.size[axis]) + where + "; expected a positive finite length");
        }
        if (!std::isfinite(box.origin[axis])) throw Error("box: the origin is not finite" + where);
        // Each factor is below 2^31, and so is the product before it: no overflow in 64 bits.
        nodes *= std::int64_t{box.cells[axis]} + 1;
        elements *= box.cells[axis];
        if (nodes > most || elements > most) {
            throw Error("box: " + std::to_string(box.cells[0]) + " x " + std::to_string(box.cells[1]) + " x " +
                        std::to_string(box.cells[2]) + " cells have more nodes or elements than 32-bit numbers count");
        }
    }
}

void name_sides(const std::array<int, 3>& cells, TetMesh::Definition& definition) {
    std::array<std::array<std::vector<std::int32_t>*, 2>, 3> sides{};
    constexpr std::array<const char*, 3> axes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sides[axis] = {&definition.node_sets[std::string(axes[axis]) + "_min"],
                       &definition.node_sets[std::string(axes[axis]) + "_max"]};
    }
    std::int32_t node = 0;
    for (int k = 0; k <= cells[2]; ++k) {
        for (int j = 0; j <= cells[1]; ++j) {
            for (int i = 0; i <= cells[0]; ++i, ++node) {
                const std::array<int, 3> place{i, j, k};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (place[axis] == 0) sides[axis][0]->push_back(node);
                    if (place[axis] == cells[axis]) sides[axis][1]->push_back(node);
                }
            }
        }
    }
}

}  // namespace

TetMesh box(const Box& box) {
    check(box);
    const auto [nx, ny, nz] = box.cells;
    TetMesh::Definition definition;
    definition.nodes.reserve(static_cast<std::size_t>(nx + 1) * static_cast<std::size_t>(ny + 1) *
                             static_cast<std::size_t>(nz + 1));
    definition.tetrahedra.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                                  static_cast<std::size_t>(nz) * (box.split == Split::five ? 5 : 6));
    const auto coordinate = [&](std::size_t axis, int index) {
        return box.origin[axis] + box.size[axis] * index / box.cells[axis];
    };
    for (int k = 0; k <= nz; ++k) {
        for (int j = 0; j <= ny; ++j) {
            for (int i = 0; i <= nx; ++i) {
                definition.nodes.push_back({coordinate(0, i), coordinate(1, j), coordinate(2, k)});
            }
        }
    }
    const std::int32_t row = nx + 1;
    const std::int32_t layer = row * (ny + 1);
    for (int k = 0; k < nz; ++k) {
        for (int j = 0; j < ny; ++j) {
            for (int i = 0; i < nx; ++i) {
                const bool is_even = ((i + j + k) % 2 == 0) != box.swap_parity;
                for (const CellCorners& corners : cell_tetrahedra(box.split, is_even)) {
                    Tetrahedron& t = definition.tetrahedra.emplace_back();
                    for (std::size_t n = 0; n < 4; ++n) {
                        const int c = corners[n];
                        t[n] = i + (c & 1) + row * (j + ((c >> 1) & 1)) + layer * (k + (c >> 2));
                    }
                }
            }
        }
    }
    name_sides(box.cells, definition);
    return TetMesh(std::move(definition));
}

}  // namespace lancet::mesh
