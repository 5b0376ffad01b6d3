#include "lancet/mesh/cut/cell.hpp"

#include <algorithm>
#include <array>

namespace lancet::mesh {

namespace {

/// An edge of a cell in a cutting plane, as it runs in another face of a piece.
struct LidEdge {
    int from = 0, to = 0;
    HalfSpace face;
};
using LidEdges = InlineVector<LidEdge, 12>;

/// Takes up a face of a piece, with its edges along the lid.
void keep(Cell& piece, Cell::Face&& face, const HalfSpace& lid, LidEdges& border) {
    const std::size_t count = face.points.size();
    for (std::size_t k = 0; k < count; ++k) {
        if (face.edges[k].plane == lid.plane) {
            border.push_back({face.points[k], face.points[(k + 1) % count], face.half});
        }
    }
    piece.faces.push_back(std::move(face));
}

/// Closes a piece with the polygon in the cutting plane, whose edges run the other way round.
void close(Cell& piece, const HalfSpace& lid, const LidEdges& border) {
    Cell::Face face{.half = lid};
    const int first = std::ranges::min(border, {}, &LidEdge::to).to;
    int point = first;
    do {
        const LidEdge& edge = *std::ranges::find(border, point, &LidEdge::to);
        face.points.push_back(point);
        face.edges.push_back(edge.face);
        point = edge.from;
    } while (point != first);
    piece.faces.push_back(std::move(face));
}

/// The point of an edge that the plane crosses, which lies in two faces.
int crossing(PlanePool& pool, int from, int to, const std::array<int, 3>& planes, Crossings& crossings) {
    const auto [low, high] = std::minmax(from, to);
    for (const Crossing& known : crossings) {
        if (known.low == low && known.high == high) return known.point;
    }
    const int point = pool.add_point(planes);
    crossings.push_back({low, high, point});
    return point;
}

}  // namespace

int PointSides::find(int point) {
    const auto at = static_cast<std::size_t>(point);
    if (known_.size() <= at) known_.resize(static_cast<std::size_t>(pool_->points()), unknown);
    return known_[at] = static_cast<std::int8_t>(pool_->side(plane_, point));
}

bool PointSides::has_above(const Cell& cell) {
    return std::ranges::any_of(cell.faces, [&](const Cell::Face& face) {
        return std::ranges::any_of(face.points, [&](int point) { return of(point) > 0; });
    });
}

std::array<int, 2> PointSides::range(std::span<const int> points) {
    std::array<int, 2> range{1, -1};
    for (const int point : points) {
        const int side = of(point);
        range[0] = std::min(range[0], side);
        range[1] = std::max(range[1], side);
    }
    return range;
}

std::array<int, 2> PointSides::range(const Cell& cell) {
    std::array<int, 2> range{1, -1};
    for (const Cell::Face& face : cell.faces) {
        const std::array<int, 2> of_face = this->range(face.points);
        range = {std::min(range[0], of_face[0]), std::max(range[1], of_face[1])};
        if (range[0] < 0 && range[1] > 0) break;
    }
    return range;
}

void PointSides::keep_points(int count) {
    known_.resize(std::min(known_.size(), static_cast<std::size_t>(count)));
}

Cell whole_tetrahedron(PlanePool& pool) {
    std::array<int, 4> corner{};
    for (int k = 0; k < 4; ++k) corner[k] = pool.add_point({(k + 1) % 4, (k + 2) % 4, (k + 3) % 4});
    Cell cell;
    for (int k = 0; k < 4; ++k) {
        Cell::Face face{.half = {k, 1}};
        const auto& corners = opposite_faces[static_cast<std::size_t>(k)];
        for (std::size_t i = 0; i < 3; ++i) {
            face.points.push_back(corner[corners[i]]);
            // The other face at the edge to the next corner is opposite the third.
            face.edges.push_back({static_cast<int>(corners[(i + 2) % 3]), 1});
        }
        cell.faces.push_back(std::move(face));
    }
    return cell;
}

bool has_face_in(const Cell& cell, PointSides& sides) {
    return std::ranges::any_of(cell.faces, [&](const Cell::Face& face) {
        return std::ranges::all_of(face.points, [&](int point) { return sides.of(point) == 0; });
    });
}

PointNumbers section_points(PlanePool& pool, const Cell& cell, PointSides& sides, Crossings& crossings) {
    PointNumbers points;
    for (const Cell::Face& face : cell.faces) {
        const std::size_t count = face.points.size();
        for (std::size_t k = 0; k < count; ++k) {
            const int from = face.points[k], to = face.points[(k + 1) % count];
            const int here = sides.of(from);
            if (here == 0 && std::ranges::find(points, from) == points.end()) points.push_back(from);
            // Each edge runs in this direction in one face.
            if (here >= 0 || sides.of(to) <= 0) continue;
            const std::array<int, 3> planes{face.half.plane, face.edges[k].plane, sides.plane()};
            points.push_back(crossing(pool, from, to, planes, crossings));
        }
    }
    return points;
}

std::optional<std::pair<Cell, Cell>> split(PlanePool& pool, const Cell& cell, int plane) {
    PointSides sides(pool, plane);
    Crossings crossings;
    return split(pool, cell, sides, crossings);
}

std::optional<std::pair<Cell, Cell>> split(PlanePool& pool, const Cell& cell, PointSides& sides, Crossings& crossings) {
    const auto [cell_lowest, cell_highest] = sides.range(cell);
    if (cell_lowest >= 0 || cell_highest <= 0) return std::nullopt;

    const HalfSpace lid_below{sides.plane(), -1}, lid_above{sides.plane(), 1};
    std::pair<Cell, Cell> pieces;
    pieces.first.faces.reserve(cell.faces.size() + 1);
    pieces.second.faces.reserve(cell.faces.size() + 1);
    LidEdges border_below, border_above;
    for (const Cell::Face& face : cell.faces) {
        Cell::Face below{.half = face.half}, above{.half = face.half};
        const auto add = [](Cell::Face& piece, int point, const HalfSpace& edge) {
            piece.points.push_back(point);
            piece.edges.push_back(edge);
        };
        const auto [lowest, highest] = sides.range(face.points);
        const std::size_t count = face.points.size();
        for (std::size_t k = 0; k < count; ++k) {
            const int from = face.points[k], to = face.points[(k + 1) % count];
            const int here = sides.of(from), there = sides.of(to);
            const HalfSpace& edge = face.edges[k];
            // From a point in the plane to the other side runs the lid, and also along the plane.
            if (lowest < 0 && here <= 0) add(below, from, here == 0 && there >= 0 ? lid_below : edge);
            if (highest > 0 && here >= 0) add(above, from, here == 0 && there <= 0 ? lid_above : edge);
            if (here * there >= 0) continue;
            const int point = crossing(pool, from, to, {face.half.plane, edge.plane, sides.plane()}, crossings);
            add(below, point, here < 0 ? lid_below : edge);
            add(above, point, here > 0 ? lid_above : edge);
        }
        if (lowest < 0) keep(pieces.first, std::move(below), lid_below, border_below);
        if (highest > 0) keep(pieces.second, std::move(above), lid_above, border_above);
    }
    close(pieces.first, lid_below, border_below);
    close(pieces.second, lid_above, border_above);
    return pieces;
}

Polygon polygon(const Cell& cell, std::size_t number) {
    const Cell::Face& face = cell.faces[number];
    return {face.half.plane, face.points, face.edges};
}

void add_cell(PartMoments& moments, const PlanePool& pool, const Cell& cell) {
    // Cones from one corner over the faces that do not touch it; no piece is negative, so nothing cancels.
    const int apex = cell.faces.front().points.front();
    for (const Cell::Face& face : cell.faces) {
        if (std::ranges::find(face.points, apex) != face.points.end()) continue;
        for (std::size_t k = 2; k < face.points.size(); ++k) {
            const std::array<int, 4> corners{apex, face.points[0], face.points[k - 1], face.points[k]};
            std::array<Barycentric, 4> places{};
            for (std::size_t i = 0; i < 4; ++i) places[i] = pool.coordinates(corners[i]);
            add_tetrahedron(moments, places, pool.volume_fraction(corners));
        }
    }
}

}  // namespace lancet::mesh
