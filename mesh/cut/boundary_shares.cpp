#include "lancet/mesh/cut/boundary_shares.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace lancet::mesh {

namespace {

void add(std::map<int, BoundaryShare>& shares, int part, double size, std::initializer_list<Barycentric> corners) {
    BoundaryShare& share = shares.try_emplace(part, BoundaryShare{.part = part}).first->second;
    for (const Barycentric& corner : corners) {
        for (std::size_t k = 0; k < 4; ++k) share.first[k] += size / static_cast<double>(corners.size()) * corner[k];
    }
}

std::vector<BoundaryShare> values(const std::map<int, BoundaryShare>& shares) {
    std::vector<BoundaryShare> list;
    for (const auto& [part, share] : shares) list.push_back(share);
    return list;
}

}  // namespace

std::vector<BoundaryShare> face_shares(const ElementCells& cells, int corner) {
    const PlanePool& pool = cells.pool();
    std::array<std::size_t, 3> of{};
    for (int k = 0; k < 3; ++k) of[static_cast<std::size_t>(k)] = static_cast<std::size_t>((corner + 1 + k) % 4);
    std::map<int, BoundaryShare> shares;
    for (std::size_t c = 0; c < cells.cells(); ++c) {
        for (const Cell::Face& face : cells.cell(c).faces) {
            if (face.half.plane != corner) continue;
            const Barycentric& a = pool.coordinates(face.points[0]);
            for (std::size_t k = 2; k < face.points.size(); ++k) {
                const Barycentric &b = pool.coordinates(face.points[k - 1]), &d = pool.coordinates(face.points[k]);
                // The area of a triangle over that of the face: the determinant of its barycentric coordinates.
                const double area = a[of[0]] * (b[of[1]] * d[of[2]] - b[of[2]] * d[of[1]]) -
                                    a[of[1]] * (b[of[0]] * d[of[2]] - b[of[2]] * d[of[0]]) +
                                    a[of[2]] * (b[of[0]] * d[of[1]] - b[of[1]] * d[of[0]]);
                add(shares, cells.part_of_cell(c), std::abs(area), {a, b, d});
            }
        }
    }
    return values(shares);
}

std::vector<BoundaryShare> edge_shares(const ElementCells& cells, int first_corner, int second_corner) {
    const PlanePool& pool = cells.pool();
    const auto lies_on_edge = [&](int point) {
        for (int k = 0; k < 4; ++k) {
            const bool is_end = k == first_corner || k == second_corner;
            if (!is_end && pool.coordinates(point)[static_cast<std::size_t>(k)] != 0) return false;
        }
        return true;
    };
    std::map<std::pair<int, int>, std::set<int>> parts_of_piece;
    for (std::size_t c = 0; c < cells.cells(); ++c) {
        for (const Cell::Face& face : cells.cell(c).faces) {
            for (std::size_t k = 0; k < face.points.size(); ++k) {
                const int from = face.points[k], to = face.points[(k + 1) % face.points.size()];
                if (lies_on_edge(from) && lies_on_edge(to)) {
                    parts_of_piece[std::minmax(from, to)].insert(cells.part_of_cell(c));
                }
            }
        }
    }
    std::map<int, BoundaryShare> shares;
    for (const auto& [piece, parts] : parts_of_piece) {
        const Barycentric &a = pool.coordinates(piece.first), &b = pool.coordinates(piece.second);
        const auto end = static_cast<std::size_t>(first_corner);
        const double length = std::abs(a[end] - b[end]) / static_cast<double>(parts.size());
        for (const int part : parts) add(shares, part, length, {a, b});
    }
    return values(shares);
}

}  // namespace lancet::mesh
