#include "lancet/mesh/generate/around.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/cell_tetrahedra.hpp"
#include "lancet/mesh/surface/inside_test.hpp"

namespace lancet::mesh {

namespace {

/// True where a triangle, given from the centre of a cube, and the cube have a place in common (Akenine-Moeller 2001):
/// none of the axes, the normal and the products of axes and edges separates them.
bool meet(const std::array<Point, 3>& corners, double half) {
    const auto separates = [&](const Point& axis) {
        std::array<double, 3> at{};
        for (std::size_t k = 0; k < 3; ++k) {
            at[k] = axis[0] * corners[k][0] + axis[1] * corners[k][1] + axis[2] * corners[k][2];
        }
        const double reach = half * (std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2]));
        return std::max({at[0], at[1], at[2]}) < -reach || std::min({at[0], at[1], at[2]}) > reach;
    };
    std::array<Point, 3> edges{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) edges[k][axis] = corners[(k + 1) % 3][axis] - corners[k][axis];
    }
    const auto cross = [](const Point& a, const Point& b) -> Point {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    if (separates(cross(edges[0], edges[1]))) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Point unit{};
        unit[axis] = 1;
        if (separates(unit)) return false;
        for (const Point& edge : edges) {
            if (separates(cross(unit, edge))) return false;
        }
    }
    return true;
}

class Grid {
  public:
    Grid(const TriangleMesh& surface, const AroundOptions& options) : surface_(surface), size_(options.cell_size) {
        if (!(size_ > 0) || !std::isfinite(size_)) {
            throw Error("mesh around a surface: cell size " + std::to_string(size_) +
                        "; expected a positive finite length");
        }
        const Bounds box = bounds(surface.vertices);
        double cells = 1;
        std::array<double, 3> counts{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // A part of a cell more, so that nothing lies on the outermost faces.
            const double extent = box[1][axis] - box[0][axis];
            counts[axis] = std::floor(extent / size_ + 1e-3) + 1;
            cells *= counts[axis];
        }
        if (!(cells <= static_cast<double>(options.most_cells))) {
            throw Error("mesh around a surface: cells of " + std::to_string(size_) + " would be " +
                        std::to_string(cells) + "; expected at most " + std::to_string(options.most_cells));
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cells_[axis] = static_cast<std::int64_t>(counts[axis]);
            origin_[axis] = (box[0][axis] + box[1][axis] - size_ * counts[axis]) / 2;
        }
        is_kept_.assign(static_cast<std::size_t>(cells), 0);
    }

    void keep_cells() {
        // What the surface passes through, to rounding rather too much than too little.
        const double half = size_ / 2 * (1 + 1e-9);
        for (const Triangle& t : surface_.triangles) {
            const std::array corners{surface_.vertices[static_cast<std::size_t>(t[0])],
                                     surface_.vertices[static_cast<std::size_t>(t[1])],
                                     surface_.vertices[static_cast<std::size_t>(t[2])]};
            const Bounds box = bounds(corners);
            const auto low = cell_of(box[0], -1e-9), high = cell_of(box[1], 1e-9);
            for_each(low, high, [&](const std::array<std::int64_t, 3>& cell) {
                std::array<Point, 3> from_centre = corners;
                const Point middle = centre(cell);
                for (Point& corner : from_centre) {
                    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] -= middle[axis];
                }
                if (meet(from_centre, half)) is_kept_[number(cell)] = 1;
            });
        }
        // The others are inside or outside as a whole, and like the one before where that is not kept for the surface.
        const InsideTest test(surface_);
        enum class Side { unknown, inside, outside };
        for (std::int64_t k = 0; k < cells_[2]; ++k) {
            for (std::int64_t j = 0; j < cells_[1]; ++j) {
                Side side = Side::unknown;
                for (std::int64_t i = 0; i < cells_[0]; ++i) {
                    std::uint8_t& is_kept = is_kept_[number({i, j, k})];
                    if (is_kept != 0) {
                        side = Side::unknown;
                        continue;
                    }
                    if (side == Side::unknown) {
                        side = test.contains(centre({i, j, k})) ? Side::inside : Side::outside;
                    }
                    is_kept = side == Side::inside ? 1 : 0;
                }
            }
        }
    }

    TetMesh mesh(Split split) const {
        TetMesh::Definition definition;
        std::vector<std::int32_t> number_of(
            static_cast<std::size_t>((cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1)), -1);
        for_each({0, 0, 0}, {cells_[0] - 1, cells_[1] - 1, cells_[2] - 1}, [&](const auto& cell) {
            if (is_kept_[number(cell)] == 0) return;
            const bool is_even = (cell[0] + cell[1] + cell[2]) % 2 == 0;
            for (const CellCorners& corners : cell_tetrahedra(split, is_even)) {
                Tetrahedron& t = definition.tetrahedra.emplace_back();
                for (std::size_t n = 0; n < 4; ++n) {
                    const int c = corners[n];
                    const std::array<std::int64_t, 3> at{cell[0] + (c & 1), cell[1] + ((c >> 1) & 1),
                                                         cell[2] + (c >> 2)};
                    std::int32_t& node = number_of[static_cast<std::size_t>(
                        at[0] + (cells_[0] + 1) * (at[1] + (cells_[1] + 1) * at[2]))];
                    if (node < 0) {
                        node = static_cast<std::int32_t>(definition.nodes.size());
                        Point& place = definition.nodes.emplace_back();
                        for (std::size_t axis = 0; axis < 3; ++axis) {
                            place[axis] = origin_[axis] + size_ * static_cast<double>(at[axis]);
                        }
                    }
                    t[n] = node;
                }
            }
        });
        return TetMesh(std::move(definition));
    }

  private:
    std::size_t number(const std::array<std::int64_t, 3>& cell) const {
        return static_cast<std::size_t>(cell[0] + cells_[0] * (cell[1] + cells_[1] * cell[2]));
    }
    Point centre(const std::array<std::int64_t, 3>& cell) const {
        Point middle{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            middle[axis] = origin_[axis] + size_ * (static_cast<double>(cell[axis]) + 0.5);
        }
        return middle;
    }
    /// The cell of a place, moved by a share of a cell along all axes.
    std::array<std::int64_t, 3> cell_of(const Point& place, double share) const {
        std::array<std::int64_t, 3> cell{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double index = std::floor((place[axis] - origin_[axis]) / size_ + share);
            cell[axis] = std::clamp(static_cast<std::int64_t>(index), std::int64_t{0}, cells_[axis] - 1);
        }
        return cell;
    }
    template <class Use>
    static void for_each(const std::array<std::int64_t, 3>& low, const std::array<std::int64_t, 3>& high,
                         const Use& use) {
        for (std::int64_t k = low[2]; k <= high[2]; ++k) {
            for (std::int64_t j = low[1]; j <= high[1]; ++j) {
                for (std::int64_t i = low[0]; i <= high[0]; ++i) use(std::array<std::int64_t, 3>{i, j, k});
            }
        }
    }

    const TriangleMesh& surface_;
    double size_;
    Point origin_{};
    std::array<std::int64_t, 3> cells_{};
    std::vector<std::uint8_t> is_kept_;
};

}  // namespace

TetMesh around(const TriangleMesh& surface, const AroundOptions& options) {
    require_valid("mesh around a surface", surface.vertices, surface.triangles);
    Grid grid(surface, options);
    grid.keep_cells();
    return grid.mesh(options.split);
}

}  // namespace lancet::mesh
