#include "lancet/mesh/cut/element_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace lancet::mesh {

namespace {

/// The box of a cell whose tetrahedron has these corners, enlarged by more than it can be rounded.
Facet::Box box_of(const PlanePool& pool, const Cell& cell, const std::array<Point, 4>& corners) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Facet::Box box{Point{infinity, infinity, infinity}, Point{-infinity, -infinity, -infinity}};
    for (const Cell::Face& face : cell.faces) {
        for (const int point : face.points) {
            const Barycentric& weights = pool.coordinates(point);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                double place = 0;
                for (std::size_t k = 0; k < 4; ++k) place += weights[k] * corners[k][axis];
                box[0][axis] = std::min(box[0][axis], place);
                box[1][axis] = std::max(box[1][axis], place);
            }
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double largest = 0;
        for (const Point& corner : corners) largest = std::max(largest, std::abs(corner[axis]));
        box[0][axis] -= 0x1p-40 * largest;
        box[1][axis] += 0x1p-40 * largest;
    }
    return box;
}

const Cell::Face* face_in(const Cell& cell, const HalfSpace& half) {
    const auto found = std::ranges::find_if(cell.faces, [&](const Cell::Face& face) {
        return face.half.plane == half.plane && face.half.side == half.side;
    });
    return found == cell.faces.end() ? nullptr : &*found;
}

}  // namespace

ElementCells::ElementCells() : plane_is_cut_(4, false), part_of_cell_{0} {
    cells_.push_back(shared(whole_tetrahedron(pool_)));
}

std::shared_ptr<SharedCell> ElementCells::shared(Cell&& cell) const {
    auto shared = std::make_shared<SharedCell>();
    shared->shape = std::move(cell);
    for (const Cell::Face& face : shared->shape.faces) {
        for (const int point : face.points) {
            for (std::size_t corner = 0; corner < 4; ++corner) {
                if (pool_.coordinates(point)[corner] == 1) shared->corners |= 1U << corner;
            }
        }
    }
    return shared;
}

int ElementCells::add_plane(const Plane& plane, const std::array<Point, 4>& corners, bool is_cut) {
    plane_is_cut_.push_back(is_cut);
    return pool_.add_plane(plane, corners);
}

/// The division of one part by the facets of a surface.
class ElementCells::Division {
  public:
    Division(ElementCells& cells, int part, const std::array<Point, 4>& corners, bool extends)
        : cells_(cells), pool_(cells.pool_), corners_(corners), part_(part), extends_(extends) {}

    /// Takes `which` cells of those that the facet crosses: all, or where one of its outer borders ends it.
    enum class Which { all, at_outer_borders };
    bool divide(const Facet& facet, Which which) {
        planes_.clear();
        bool is_touched = false, is_cover = false;
        const std::size_t count = cells_.cells();
        for (std::size_t c = 0; c < count; ++c) {
            if (cells_.part_of_cell(c) != part_ || are_apart(box(c), facet.bounds)) continue;
            const auto [lowest, highest] = plane(facet).range(cells_.cell(c));
            if (lowest < 0 && highest > 0) {
                is_touched = divide(facet, c, which) || is_touched;
            } else {
                is_cover = is_cover || (which == Which::all && has_face_in(cells_.cell(c), plane(facet)));
            }
        }
        if (is_cover) {
            Cover cover{.plane = plane(facet).plane()};
            for (std::size_t k = 0; k < facet.borders.size(); ++k) cover.borders.push_back(border(facet, k).plane());
            cells_.covers_.push_back(std::move(cover));
            for (Joint& joint : cells_.joints_) joint.is_known = false;
        }
        return is_touched || is_cover;
    }

  private:
    int number_of(const Plane& plane, bool is_cut) {
        const auto known = std::ranges::find(added_, &plane, &std::pair<const Plane*, int>::first);
        if (known != added_.end()) return known->second;
        added_.emplace_back(&plane, cells_.add_plane(plane, corners_, is_cut));
        return added_.back().second;
    }
    /// The planes of the facet, which are added to the pool where they are needed.
    PointSides& plane(const Facet& facet) {
        if (planes_.empty()) planes_.emplace_back(pool_, number_of(facet.plane, true));
        return planes_.front();
    }
    PointSides& border(const Facet& facet, std::size_t k) {
        plane(facet);
        while (planes_.size() <= k + 1) {
            const Plane& next = facet.borders[planes_.size() - 1].plane;
            planes_.emplace_back(pool_, number_of(next, false));
        }
        return planes_[k + 1];
    }

    const Facet::Box& box(std::size_t number) {
        SharedCell& cell = *cells_.cells_[number];
        if (!cell.place || cell.place->corners != corners_) {
            cell.place = {corners_, box_of(pool_, cell.shape, corners_)};
        }
        return cell.place->box;
    }

    /// Divides a cell that the plane of the facet crosses; false where the facet itself does not.
    bool divide(const Facet& facet, std::size_t c, Which which) {
        for (std::size_t k = 0; k < facet.borders.size(); ++k) {
            if (!border(facet, k).has_above(cells_.cell(c))) return false;
        }
        const int points = pool_.points();
        Crossings crossings;
        std::optional<Inside> inside = clipped(facet, c, crossings, which, false);
        if (inside && extends_) inside = clipped(facet, c, crossings, Which::all, true);
        if (!inside) {
            pool_.keep_points(points);
            for (PointSides& sides : planes_) sides.keep_points(points);
            return false;
        }
        auto halves = split(pool_, inside->cell ? *inside->cell : cells_.cell(c), plane(facet), crossings);
        cells_.replace(c, std::move(halves->first), std::move(halves->second), std::move(inside->outside), planes_);
        return true;
    }

    /// What is left of a cell when only as much is cut off by borders as keeps the plane's section with it inside of
    /// all of them, and what was cut off.
    struct Inside {
        std::optional<Cell> cell{};  ///< nothing: all of it
        std::vector<Cell> outside{};
    };
    /// Nothing where no area of the section is inside.
    std::optional<Inside> clipped(const Facet& facet, std::size_t c, Crossings& crossings, Which which,
                                  bool only_inner) {
        Inside inside;
        PointNumbers section = section_points(pool_, cells_.cell(c), plane(facet), crossings);
        std::vector<std::size_t> crossed;
        for (std::size_t k = 0; k < facet.borders.size(); ++k) {
            if (only_inner && facet.borders[k].is_outer) continue;
            const auto [lowest, highest] = border(facet, k).range(section);
            if (highest <= 0) return std::nullopt;
            if (lowest < 0) crossed.push_back(k);
        }
        // Behind an outer border no facet of this surface goes on: what is cut off there is not divided by the others.
        const auto is_inner = [&](std::size_t k) { return !facet.borders[k].is_outer; };
        std::stable_partition(crossed.begin(), crossed.end(), [&](std::size_t k) { return !is_inner(k); });
        if (which == Which::at_outer_borders && std::ranges::all_of(crossed, is_inner)) return std::nullopt;
        for (const std::size_t k : crossed) {
            const auto [lowest, highest] = border(facet, k).range(section);
            if (highest <= 0) return std::nullopt;
            if (lowest >= 0) continue;
            Crossings of_border;
            auto pieces = split(pool_, inside.cell ? *inside.cell : cells_.cell(c), border(facet, k), of_border);
            inside.outside.push_back(std::move(pieces->first));
            inside.cell = std::move(pieces->second);
            section = section_points(pool_, *inside.cell, plane(facet), crossings);
        }
        return inside;
    }

    ElementCells& cells_;
    PlanePool& pool_;
    const std::array<Point, 4>& corners_;
    int part_;
    bool extends_;
    std::vector<std::pair<const Plane*, int>> added_;  ///< with their numbers
    std::vector<PointSides> planes_;  ///< of the facet and of its borders, as far as they have been needed
};

bool ElementCells::divide(int part, const Facets& facets, std::span<const Facet* const> near,
                          const std::array<Point, 4>& corners, bool extends) {
    Division division(*this, part, corners, extends);
    bool is_touched = false;
    // First what ends at outer borders: inner ones then do not go on behind these, where later strokes come.
    constexpr std::size_t many = 4;
    if (near.size() > many) {
        for (const Facet* facet : near) {
            const bool has_outer = std::ranges::any_of(facet->borders, &Facet::Border::is_outer);
            if (!has_outer) continue;
            is_touched = division.divide(*facet, Division::Which::at_outer_borders) || is_touched;
        }
    }
    for (const Facet* facet : near) is_touched = division.divide(*facet, Division::Which::all) || is_touched;
    if (is_touched) facets_.push_back(facets);
    return is_touched;
}

void ElementCells::replace(std::size_t cell, Cell&& below, Cell&& above, std::vector<Cell>&& outside,
                           std::span<PointSides> planes) {
    const std::size_t first_new = cells_.size();
    cells_[cell] = shared(std::move(below));
    cells_.push_back(shared(std::move(above)));
    for (Cell& piece : outside) cells_.push_back(shared(std::move(piece)));
    part_of_cell_.resize(cells_.size(), part_of_cell_[cell]);
    replace_joints(cell, first_new, planes);
}

void ElementCells::replace_joints(std::size_t divided, std::size_t first_new, std::span<PointSides> planes) {
    std::vector<std::size_t> pieces{divided};
    for (std::size_t c = first_new; c < cells_.size(); ++c) pieces.push_back(c);
    const auto number = static_cast<int>(divided);
    // Of most pieces it is told by one of the planes that they have nothing of what the cell shared with another.
    const auto is_beyond_new_edge = [&](const Cell::Face& face, const Joint& joint, bool is_below) {
        const auto other = static_cast<std::size_t>(is_below ? joint.above : joint.below);
        const Cell::Face* behind = face_in(cell(other), {joint.plane, is_below ? 1 : -1});
        return std::ranges::any_of(face.edges, [&](const HalfSpace& edge) {
            const auto found = std::ranges::find(planes, edge.plane, &PointSides::plane);
            return found != planes.end() &&
                   std::ranges::none_of(behind->points, [&](int point) { return edge.side * found->of(point) > 0; });
        });
    };
    std::vector<Joint> further;
    std::erase_if(joints_, [&](const Joint& joint) {
        if (joint.below != number && joint.above != number) return false;
        const bool is_below = joint.below == number;
        const std::size_t first = further.size();
        for (const std::size_t piece : pieces) {
            const Cell::Face* face = face_in(cell(piece), {joint.plane, is_below ? -1 : 1});
            if (face == nullptr || is_beyond_new_edge(*face, joint, is_below)) continue;
            Joint& added = further.emplace_back(joint);
            (is_below ? added.below : added.above) = static_cast<int>(piece);
        }
        // What only one piece can have had is there as it was.
        const bool is_shared = further.size() > first + 1;
        for (std::size_t k = first; is_shared && k < further.size(); ++k) further[k].is_known = false;
        return true;
    });
    for (const std::size_t below : pieces) {
        for (const Cell::Face& face : cell(below).faces) {
            if (face.half.side > 0 || is_cut(face.half.plane)) continue;
            for (const std::size_t above : pieces) {
                if (above == below || face_in(cell(above), {face.half.plane, 1}) == nullptr) continue;
                further.push_back({static_cast<int>(below), static_cast<int>(above), face.half.plane});
            }
        }
    }
    joints_.insert(joints_.end(), further.begin(), further.end());
}

bool ElementCells::share_area(const Joint& joint) {
    if (part_of_cell_[static_cast<std::size_t>(joint.below)] != part_of_cell_[static_cast<std::size_t>(joint.above)]) {
        return false;
    }
    const Cell::Face* below = face_in(cell(static_cast<std::size_t>(joint.below)), {joint.plane, -1});
    const Cell::Face* above = face_in(cell(static_cast<std::size_t>(joint.above)), {joint.plane, 1});
    return are_joined(pool_, *below, *above, covers_);
}

std::vector<int> ElementCells::regroup() {
    std::vector<int> group(cells_.size());
    std::iota(group.begin(), group.end(), 0);
    const auto find = [&](int cell) {
        while (group[cell] != cell) cell = group[cell] = group[group[cell]];
        return cell;
    };
    const auto unite = [&](int a, int b) { group[std::max(a, b)] = std::min(a, b); };
    for (const Joint& joint : joints_) {
        if (joint.is_known) unite(find(joint.below), find(joint.above));
    }
    // What hangs together anyhow need not be looked at until it does not any more; what shares no area never will.
    std::erase_if(joints_, [&](Joint& joint) {
        if (joint.is_known) return false;
        const int a = find(joint.below), b = find(joint.above);
        if (a == b) return false;
        if (!share_area(joint)) return true;
        joint.is_known = true;
        unite(a, b);
        return false;
    });
    std::vector<std::pair<int, int>> order;  // {part before, first cell}
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (find(static_cast<int>(c)) == static_cast<int>(c)) order.emplace_back(part_of_cell_[c], c);
    }
    std::sort(order.begin(), order.end());
    std::vector<int> before, number(cells_.size());
    for (const auto& [part, cell] : order) {
        number[static_cast<std::size_t>(cell)] = static_cast<int>(before.size());
        before.push_back(part);
    }
    for (std::size_t c = 0; c < cells_.size(); ++c) part_of_cell_[c] = number[find(static_cast<int>(c))];
    parts_ = static_cast<int>(before.size());
    return before;
}

const PartMoments& ElementCells::moments_of_cell(std::size_t cell) const {
    SharedCell& shared = *cells_[cell];
    if (!shared.moments) {
        shared.moments = empty_moments();
        add_cell(*shared.moments, pool_, shared.shape);
    }
    return *shared.moments;
}

PartMoments ElementCells::moments(int part) const {
    if (parts_ == 1) return {};
    PartMoments moments = empty_moments();
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (part_of_cell_[c] != part) continue;
        add_weighted(moments, moments_of_cell(c), 1);
    }
    return moments;
}

std::vector<ElementCells::Section> ElementCells::sections() const {
    PlanePool pool = pool_;  // clipping adds points
    std::vector<Section> sections;
    for (std::size_t a = 0; a < cells_.size(); ++a) {
        for (std::size_t f = 0; f < cell(a).faces.size(); ++f) {
            const HalfSpace& half = cell(a).faces[f].half;
            if (!is_cut(half.plane) || half.side < 0) continue;
            for (std::size_t b = 0; b < cells_.size(); ++b) {
                for (std::size_t g = 0; g < cell(b).faces.size(); ++g) {
                    const HalfSpace& other = cell(b).faces[g].half;
                    if (other.plane != half.plane || other.side > 0) continue;
                    Polygon shared = polygon(cell(a), f);
                    for (const HalfSpace& edge : polygon(cell(b), g).edges) {
                        shared = clip(pool, shared, edge);
                        if (shared.points.empty()) break;
                    }
                    if (shared.points.empty()) continue;
                    Section section{.plane = half.plane, .above = part_of_cell_[a], .below = part_of_cell_[b]};
                    for (const int point : shared.points) section.corners.push_back(pool.coordinates(point));
                    sections.push_back(std::move(section));
                }
            }
        }
    }
    return sections;
}

int ElementCells::add_guide(const std::array<double, 4>& values) {
    plane_is_cut_.push_back(false);
    return pool_.add_values(values);
}

ElementCells::Halves ElementCells::halves(int part, int plane) const {
    PlanePool pool = pool_;
    Halves halves{.below = empty_moments(), .above = empty_moments()};
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (part_of_cell_[c] != part) continue;
        if (const auto pieces = split(pool, cell(c), plane)) {
            add_cell(halves.below, pool, pieces->first);
            add_cell(halves.above, pool, pieces->second);
            std::vector<Barycentric>& polygon = halves.section.emplace_back();
            for (const int point : pieces->second.faces.back().points) polygon.push_back(pool.coordinates(point));
            continue;
        }
        const bool is_above = PointSides(pool, plane).has_above(cell(c));
        add_weighted(is_above ? halves.above : halves.below, moments_of_cell(c), 1);
    }
    return halves;
}

bool ElementCells::touches(int part, int corner) const {
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (part_of_cell_[c] == part && (cells_[c]->corners >> corner & 1U) != 0) return true;
    }
    return false;
}

int ElementCells::part_at(const Barycentric& place) const {
    int best = 0;
    double best_depth = -std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        double depth = std::numeric_limits<double>::infinity();
        for (const Cell::Face& face : cell(c).faces) {
            depth = std::min(depth, face.half.side * pool_.value(face.half.plane, place));
        }
        if (depth <= best_depth) continue;
        best_depth = depth;
        best = part_of_cell_[c];
    }
    return best;
}

}  // namespace lancet::mesh
