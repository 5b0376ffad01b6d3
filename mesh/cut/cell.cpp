#include "lancet/mesh/cut/cell.hpp"

#include <algorithm>
#include <map>

namespace lancet::mesh {

namespace {

struct Sides {
    bool has_below = false, has_above = false;
};

Sides sides_of(const PlanePool& pool, const Cell& cell, int plane) {
    Sides sides;
    for (const Cell::Face& face : cell.faces) {
        for (const int point : face.points) {
            const int side = pool.side(plane, point);
            sides.has_below = sides.has_below || side < 0;
            sides.has_above = sides.has_above || side > 0;
        }
    }
    return sides;
}

/// The other face at the edge that runs from `from` to `to` in a face.
const Cell::Face& neighbour(const Cell& cell, int from, int to) {
    for (const Cell::Face& face : cell.faces) {
        const std::size_t count = face.points.size();
        for (std::size_t k = 0; k < count; ++k) {
            if (face.points[k] == to && face.points[(k + 1) % count] == from) return face;
        }
    }
    return cell.faces.front();  // never reached: every edge of a cell has two faces
}

/// Closes a piece with the polygon in the cutting plane, given by its edges as they run in the other faces.
void close(Cell& piece, const HalfSpace& half, const std::map<int, int>& next_in_faces) {
    std::map<int, int> next;
    for (const auto& [from, to] : next_in_faces) next[to] = from;
    Cell::Face lid{.half = half};
    const int first = next.begin()->first;
    int point = first;
    do {
        lid.points.push_back(point);
        point = next.at(point);
    } while (point != first);
    piece.faces.push_back(std::move(lid));
}

}  // namespace

Cell whole_tetrahedron(PlanePool& pool) {
    std::array<int, 4> corner{};
    for (int k = 0; k < 4; ++k) corner[k] = pool.add_point({(k + 1) % 4, (k + 2) % 4, (k + 3) % 4});
    Cell cell;
    for (int k = 0; k < 4; ++k) {
        Cell::Face face{.half = {k, 1}};
        for (const int point : opposite_faces[static_cast<std::size_t>(k)]) face.points.push_back(corner[point]);
        cell.faces.push_back(std::move(face));
    }
    return cell;
}

bool is_crossed(const PlanePool& pool, const Cell& cell, int plane) {
    const Sides sides = sides_of(pool, cell, plane);
    return sides.has_below && sides.has_above;
}

bool reaches_above(const PlanePool& pool, const Cell& cell, int plane) {
    return sides_of(pool, cell, plane).has_above;
}

bool has_face_in(const PlanePool& pool, const Cell& cell, int plane) {
    return std::ranges::any_of(cell.faces, [&](const Cell::Face& face) {
        return std::ranges::all_of(face.points, [&](int point) { return pool.side(plane, point) == 0; });
    });
}

std::optional<std::pair<Cell, Cell>> split(PlanePool& pool, const Cell& cell, int plane) {
    const Sides sides = sides_of(pool, cell, plane);
    if (!sides.has_below || !sides.has_above) return std::nullopt;

    std::pair<Cell, Cell> pieces;
    std::map<int, int> border_below, border_above;  // edges in the plane, as they run in the faces
    std::map<std::pair<int, int>, int> crossings;
    for (const Cell::Face& face : cell.faces) {
        Cell::Face below{.half = face.half}, above{.half = face.half};
        std::map<int, bool> is_in_plane;
        const std::size_t count = face.points.size();
        int lowest = 0, highest = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const int from = face.points[k], to = face.points[(k + 1) % count];
            const int here = pool.side(plane, from), there = pool.side(plane, to);
            lowest = std::min(lowest, here);
            highest = std::max(highest, here);
            if (here <= 0) below.points.push_back(from);
            if (here >= 0) above.points.push_back(from);
            is_in_plane[from] = here == 0;
            if (here * there >= 0) continue;
            const auto [place, is_new] = crossings.try_emplace(std::minmax(from, to), 0);
            if (is_new) {
                place->second = pool.add_point({face.half.plane, neighbour(cell, from, to).half.plane, plane});
            }
            below.points.push_back(place->second);
            above.points.push_back(place->second);
            is_in_plane[place->second] = true;
        }
        const auto keep = [&](Cell::Face& kept, Cell& piece, std::map<int, int>& border) {
            for (std::size_t k = 0; k < kept.points.size(); ++k) {
                const int from = kept.points[k], to = kept.points[(k + 1) % kept.points.size()];
                if (is_in_plane[from] && is_in_plane[to]) border[from] = to;
            }
            piece.faces.push_back(std::move(kept));
        };
        if (lowest < 0) keep(below, pieces.first, border_below);
        if (highest > 0) keep(above, pieces.second, border_above);
    }
    close(pieces.first, {plane, -1}, border_below);
    close(pieces.second, {plane, 1}, border_above);
    return pieces;
}

Polygon polygon(const Cell& cell, std::size_t number) {
    const Cell::Face& face = cell.faces[number];
    Polygon polygon{.plane = face.half.plane, .points = face.points};
    for (std::size_t k = 0; k < face.points.size(); ++k) {
        polygon.edges.push_back(neighbour(cell, face.points[k], face.points[(k + 1) % face.points.size()]).half);
    }
    return polygon;
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
