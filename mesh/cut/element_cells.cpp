#include "lancet/mesh/cut/element_cells.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace lancet::mesh {

namespace {

std::shared_ptr<SharedCell> shared(Cell&& cell) {
    return std::make_shared<SharedCell>(std::move(cell));
}

}  // namespace

ElementCells::ElementCells() : plane_is_cut_(4, false), cells_{shared(whole_tetrahedron(pool_))}, part_of_cell_{0} {}

int ElementCells::add_plane(const Plane& plane, const std::array<Point, 4>& corners, bool is_cut) {
    plane_is_cut_.push_back(is_cut);
    return pool_.add_plane(plane, corners);
}

bool ElementCells::divide(int part, const Facets& facets, const std::array<Point, 4>& corners, bool extends) {
    bool is_touched = false;
    for (const Facet& facet : *facets) {
        if (may_touch(facet, corners)) divide(part, facet, corners, extends, is_touched);
    }
    if (is_touched) facets_.push_back(facets);
    return is_touched;
}

void ElementCells::divide(int part, const Facet& facet, const std::array<Point, 4>& corners, bool extends,
                          bool& is_touched) {
    const int plane = add_plane(facet.plane, corners, true);
    std::vector<int> borders;
    const auto border = [&](std::size_t k) {
        while (borders.size() <= k) {
            borders.push_back(add_plane(facet.borders[borders.size()].plane, corners, false));
        }
        return borders[k];
    };
    const std::size_t count = cells_.size();
    bool is_cover = false;
    for (std::size_t c = 0; c < count; ++c) {
        if (part_of_cell_[c] != part) continue;
        if (!is_crossed(pool_, cell(c), plane)) {
            is_cover = is_cover || has_face_in(pool_, cell(c), plane);
            continue;
        }
        bool misses = false;
        for (std::size_t k = 0; k < facet.borders.size() && !misses; ++k) {
            misses = !reaches_above(pool_, cell(c), border(k));
        }
        if (misses) continue;
        Cell inside = cell(c);
        std::vector<Cell> outside;
        for (std::size_t k = 0; k < facet.borders.size() && !misses; ++k) {
            if (auto pieces = split(pool_, inside, border(k))) {
                outside.push_back(std::move(pieces->first));
                inside = std::move(pieces->second);
            } else {
                misses = !reaches_above(pool_, inside, border(k));
            }
            misses = misses || !is_crossed(pool_, inside, plane);
        }
        if (misses) continue;
        if (extends) {
            inside = cell(c);
            outside.clear();
            for (std::size_t k = 0; k < facet.borders.size(); ++k) {
                if (facet.borders[k].is_outer) continue;
                auto pieces = split(pool_, inside, border(k));
                if (!pieces) continue;
                outside.push_back(std::move(pieces->first));
                inside = std::move(pieces->second);
            }
        }
        auto halves = split(pool_, inside, plane);
        cells_[c] = shared(std::move(halves->first));
        cells_.push_back(shared(std::move(halves->second)));
        for (Cell& cell : outside) cells_.push_back(shared(std::move(cell)));
        part_of_cell_.resize(cells_.size(), part);
        is_touched = true;
    }
    if (is_cover) {
        for (std::size_t k = 0; k < facet.borders.size(); ++k) border(k);
        covers_.push_back({plane, borders});
        is_touched = true;
    }
}

std::vector<int> ElementCells::regroup() {
    std::vector<int> group(cells_.size());
    std::iota(group.begin(), group.end(), 0);
    const auto find = [&](int cell) {
        while (group[cell] != cell) cell = group[cell] = group[group[cell]];
        return cell;
    };
    // Open areas lie in planes of borders, which divide cells without separating them.
    struct Side {
        int cell;
        Polygon polygon;
    };
    std::map<int, std::array<std::vector<Side>, 2>> open;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        const Cell& shape = cell(c);
        for (std::size_t f = 0; f < shape.faces.size(); ++f) {
            const HalfSpace& half = shape.faces[f].half;
            if (half.plane < 4 || is_cut(half.plane)) continue;
            open[half.plane][half.side > 0 ? 1 : 0].push_back({static_cast<int>(c), polygon(shape, f)});
        }
    }
    for (const auto& [plane, sides] : open) {
        for (const Side& below : sides[0]) {
            for (const Side& above : sides[1]) {
                const int a = find(below.cell), b = find(above.cell);
                if (a == b || part_of_cell_[below.cell] != part_of_cell_[above.cell]) continue;
                if (are_joined(pool_, below.polygon, above.polygon, covers_)) {
                    group[std::max(a, b)] = std::min(a, b);
                }
            }
        }
    }
    std::vector<std::pair<int, int>> order;  // {part before, first cell}
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (find(static_cast<int>(c)) == static_cast<int>(c)) order.emplace_back(part_of_cell_[c], c);
    }
    std::sort(order.begin(), order.end());
    std::vector<int> before;
    std::map<int, int> number;
    for (const auto& [part, cell] : order) {
        number[cell] = static_cast<int>(before.size());
        before.push_back(part);
    }
    for (std::size_t c = 0; c < cells_.size(); ++c) part_of_cell_[c] = number[find(static_cast<int>(c))];
    parts_ = static_cast<int>(before.size());
    return before;
}

PartMoments ElementCells::moments(int part) const {
    if (parts_ == 1) return {};
    PartMoments moments = empty_moments();
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (part_of_cell_[c] != part) continue;
        if (!cells_[c]->moments) {
            cells_[c]->moments = empty_moments();
            add_cell(*cells_[c]->moments, pool_, cell(c));
        }
        add_weighted(moments, *cells_[c]->moments, 1);
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
        const bool is_above = reaches_above(pool, cell(c), plane);
        add_cell(is_above ? halves.above : halves.below, pool, cell(c));
    }
    return halves;
}

bool ElementCells::touches(int part, int corner) const {
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (part_of_cell_[c] != part) continue;
        for (const Cell::Face& face : cell(c).faces) {
            for (const int point : face.points) {
                if (pool_.coordinates(point)[static_cast<std::size_t>(corner)] == 1) return true;
            }
        }
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
