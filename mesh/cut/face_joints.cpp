#include "lancet/mesh/cut/face_joints.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "lancet/mesh/cut/polygon.hpp"

namespace lancet::mesh {

namespace {

/// The plane of the face in a pool of its own, where the face's corners are 0, 1 and 2.
constexpr int face_plane = 3;

/// Takes what one element has in the face over to the pool of the face.
class Side {
  public:
    Side(PlanePool& pool, const FaceSide& side) : pool_(pool), side_(side) {}

    std::vector<FacePiece> pieces() {
        if (side_.cells == nullptr) return {{0, whole_face()}};
        std::vector<FacePiece> pieces;
        for (std::size_t c = 0; c < side_.cells->cells(); ++c) {
            const Cell& cell = side_.cells->cell(c);
            for (std::size_t f = 0; f < cell.faces.size(); ++f) {
                if (cell.faces[f].half.plane != side_.face) continue;
                pieces.push_back({side_.cells->part_of_cell(c), moved(polygon(cell, f))});
            }
        }
        return pieces;
    }

    void add_covers(std::vector<Cover>& covers) {
        if (side_.cells == nullptr) return;
        for (const Cover& cover : side_.cells->covers()) {
            const bool lies_in_face = std::ranges::all_of(side_.corners, [&](int corner) {
                return side_.cells->pool().side_of_corner(cover.plane, corner) == 0;
            });
            if (!lies_in_face) continue;
            Cover taken{.plane = face_plane};
            for (const int border : cover.borders) taken.borders.push_back(trace(border));
            covers.push_back(std::move(taken));
        }
    }

  private:
    Polygon whole_face() {
        Polygon face{.plane = face_plane};
        for (int k = 0; k < 3; ++k) {
            // Corner k lies between the edges opposite the corners before and behind it.
            face.points.push_back(pool_.find_or_add_point({face_plane, (k + 1) % 3, (k + 2) % 3}));
            face.edges.push_back({(k + 2) % 3, 1});
        }
        return face;
    }

    /// The line in which a plane of the element meets the face.
    int trace(int plane) {
        if (plane < 4) {
            return static_cast<int>(std::ranges::find(side_.corners, plane) - side_.corners.begin());
        }
        const auto [place, is_new] = traces_.try_emplace(plane, 0);
        if (is_new) place->second = pool_.add_trace(side_.cells->pool(), plane, side_.corners);
        return place->second;
    }

    Polygon moved(const Polygon& original) {
        Polygon polygon{.plane = face_plane};
        const std::size_t count = original.points.size();
        for (const HalfSpace& edge : original.edges) polygon.edges.push_back({trace(edge.plane), edge.side});
        for (std::size_t k = 0; k < count; ++k) {
            polygon.points.push_back(pool_.find_or_add_point(
                {face_plane, polygon.edges[(k + count - 1) % count].plane, polygon.edges[k].plane}));
        }
        return polygon;
    }

    PlanePool& pool_;
    const FaceSide& side_;
    std::map<int, int> traces_;
};

/// The parts that have a piece of the face, ascending.
std::vector<int> parts_at(const FaceSide& side) {
    if (side.cells == nullptr) return {0};
    std::vector<int> parts;
    for (std::size_t c = 0; c < side.cells->cells(); ++c) {
        const int part = side.cells->part_of_cell(c);
        if (std::ranges::find(parts, part) != parts.end()) continue;
        const bool has_piece = std::ranges::any_of(
            side.cells->cell(c).faces, [&](const Cell::Face& face) { return face.half.plane == side.face; });
        if (has_piece) parts.push_back(part);
    }
    std::ranges::sort(parts);
    return parts;
}

bool is_covered(const FaceSide& side) {
    if (side.cells == nullptr) return false;
    return std::ranges::any_of(side.cells->covers(), [&](const Cover& cover) {
        return std::ranges::all_of(
            side.corners, [&](int corner) { return side.cells->pool().side_of_corner(cover.plane, corner) == 0; });
    });
}

}  // namespace

std::vector<FacePiece> face_pieces(PlanePool& pool, const FaceSide& side) {
    return Side(pool, side).pieces();
}

std::vector<std::pair<int, int>> joined_parts(const FaceSide& a, const FaceSide& b,
                                              const std::function<bool(int, int)>& may_join) {
    const std::vector<int> parts_a = parts_at(a), parts_b = parts_at(b);
    std::vector<std::pair<int, int>> candidates;
    for (const int part_a : parts_a) {
        for (const int part_b : parts_b) {
            if (may_join(part_a, part_b)) candidates.emplace_back(part_a, part_b);
        }
    }
    // What has all of one side shares an area with everything on the other.
    const bool is_open = !is_covered(a) && !is_covered(b);
    if (candidates.empty() || (is_open && (parts_a.size() == 1 || parts_b.size() == 1))) return candidates;
    PlanePool pool;
    Side of_a(pool, a), of_b(pool, b);
    std::vector<Cover> covers;
    of_a.add_covers(covers);
    of_b.add_covers(covers);
    const std::vector<FacePiece> pieces_a = of_a.pieces(), pieces_b = of_b.pieces();
    std::set<std::pair<int, int>> joined;
    for (const FacePiece& piece_a : pieces_a) {
        for (const FacePiece& piece_b : pieces_b) {
            const std::pair pair(piece_a.part, piece_b.part);
            if (joined.contains(pair) || !std::ranges::binary_search(candidates, pair)) continue;
            if (are_joined(pool, piece_a.polygon, piece_b.polygon, covers)) joined.insert(pair);
        }
    }
    return {joined.begin(), joined.end()};
}

}  // namespace lancet::mesh
