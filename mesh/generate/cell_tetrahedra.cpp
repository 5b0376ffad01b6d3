#include "lancet/mesh/generate/cell_tetrahedra.hpp"

namespace lancet::mesh {

namespace {

/// Six times the volume of corners of the unit cell.
constexpr int determinant(const CellCorners& c) {
    std::array<std::array<int, 3>, 3> e{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis) e[row][axis] = ((c[row + 1] >> axis) & 1) - ((c[0] >> axis) & 1);
    }
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

constexpr std::array<CellCorners, 5> even_cell{{{3, 5, 6, 0}, {1, 0, 5, 3}, {2, 0, 3, 6}, {4, 0, 6, 5}, {7, 3, 5, 6}}};
constexpr std::array<CellCorners, 5> odd_cell{{{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}}};
constexpr std::array<CellCorners, 6> kuhn_cell{
    {{0, 1, 3, 7}, {0, 1, 7, 5}, {0, 2, 7, 3}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 7, 6}}};

template <std::size_t Count>
constexpr bool fills_cell(const std::array<CellCorners, Count>& cell) {
    int sum = 0;
    for (const CellCorners& corners : cell) {
        if (determinant(corners) <= 0) return false;
        sum += determinant(corners);
    }
    return sum == 6;
}
static_assert(fills_cell(even_cell) && fills_cell(odd_cell) && fills_cell(kuhn_cell));

}  // namespace

std::span<const CellCorners> cell_tetrahedra(Split split, bool is_even) {
    if (split == Split::six) return kuhn_cell;
    return is_even ? even_cell : odd_cell;
}

}  // namespace lancet::mesh
