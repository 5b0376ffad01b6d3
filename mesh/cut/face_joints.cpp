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

bool is_whole(const FaceSide& side) {
    return side.cells == nullptr || (side.cells->parts() == 1 && side.cells->covers().empty());
}

}  // namespace

std::vector<FacePiece> face_pieces(PlanePool& pool, const FaceSide& side) {
    return Side(pool, side).pieces();
}

std::vector<std::pair<int, int>> joined_parts(const FaceSide& a, const FaceSide& b,
                                              const std::function<bool(int, int)>& may_join) {
    if (is_whole(a) && is_whole(b)) {
        if (may_join(0, 0)) return {{0, 0}};
        return {};
    }
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
            if (joined.contains(pair) || !may_join(pair.first, pair.second)) continue;
            if (are_joined(pool, piece_a.polygon, piece_b.polygon, covers)) joined.insert(pair);
        }
    }
    return {joined.begin(), joined.end()};
}

}  // namespace lancet::mesh
