#include "lancet/mesh/embed/embedded_surface.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/embed/corner_numbers.hpp"
#include "lancet/mesh/embed/embedding.hpp"
#include "lancet/mesh/embed/polygon_triangles.hpp"
#include "lancet/mesh/face_neighbours.hpp"

namespace lancet::mesh {

namespace {

std::array<Point, 4> corners_of(const TetMesh& mesh, std::int32_t element) {
    const Tetrahedron& t = mesh.tetrahedra()[static_cast<std::size_t>(element)];
    std::array<Point, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.nodes()[static_cast<std::size_t>(t[k])];
    return corners;
}

Point place_in(const std::array<Point, 4>& corners, const Barycentric& weights) {
    Point place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        place[axis] = (weights[0] * corners[0][axis] + weights[1] * corners[1][axis]) +
                      (weights[2] * corners[2][axis] + weights[3] * corners[3][axis]);
    }
    return place;
}

/// Twice the area of loops as a vector: their normal.
Point area_vector(const std::vector<std::vector<std::int32_t>>& loops, std::span<const Point> places) {
    Point sum{};
    for (const std::vector<std::int32_t>& loop : loops) {
        for (std::size_t k = 2; k < loop.size(); ++k) {
            const Point &a = places[static_cast<std::size_t>(loop[0])],
                        &b = places[static_cast<std::size_t>(loop[k - 1])],
                        &c = places[static_cast<std::size_t>(loop[k])];
            const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
            sum[0] += u[1] * v[2] - u[2] * v[1];
            sum[1] += u[2] * v[0] - u[0] * v[2];
            sum[2] += u[0] * v[1] - u[1] * v[0];
        }
    }
    return sum;
}

}  // namespace

EmbeddedSurface::EmbeddedSurface(const CutMesh& cut, TriangleMesh surface) : facets_(std::move(surface)) {
    const TetMesh& mesh = cut.mesh();
    const TriangleMesh& original = facets_.surface();
    const Embedding embedding = embed(mesh, original.vertices);
    const auto box = mesh.bounds();
    const double size = std::hypot(box[1][0] - box[0][0], box[1][1] - box[0][1], box[1][2] - box[0][2]);
    for (std::size_t v = 0; v < original.vertices.size(); ++v) {
        if (embedding.distances[v] > 1e-9 * size) {
            throw Error("embedded surface: vertex " + std::to_string(v) + " lies outside of the mesh by " +
                        std::to_string(embedding.distances[v]) + "; expected a surface inside of the mesh");
        }
        points_.push_back({embedding.elements[v], embedding.weights[v]});
        at_rest_.push_back(original.vertices[v]);
    }
    if (facets_.is_closed()) inside_.emplace(facets_.moved());
    for (const auto& [a, b, c] : facets_.moved().triangles) {
        triangle_boxes_.push_back(bounds(std::array{facets_.moved().vertices[static_cast<std::size_t>(a)],
                                                    facets_.moved().vertices[static_cast<std::size_t>(b)],
                                                    facets_.moved().vertices[static_cast<std::size_t>(c)]}));
    }
    elements_ = mesh.tetrahedra().size();
    for (std::size_t e = 0; e < elements_; ++e) {
        element_boxes_.push_back(bounds(corners_of(mesh, static_cast<std::int32_t>(e))));
    }
    triangle_grid_ = BoxGrid(triangle_boxes_);
    element_grid_ = BoxGrid(element_boxes_);
    neighbours_ = face_neighbours(mesh);
    is_divided_.assign(original.triangles.size(), 0);
    leaves_.assign(original.triangles.size(), 0);
    assemble(cut);
    update(cut);
}

bool EmbeddedSurface::update(const CutMesh& cut) {
    if (cut.mesh().tetrahedra().size() != elements_) {
        throw Error("embedded surface: the mesh has " + std::to_string(cut.mesh().tetrahedra().size()) +
                    " elements; expected the " + std::to_string(elements_) + " to which the surface is bound");
    }
    std::set<std::int32_t> renewed;
    for (const std::int32_t element : cut.touched_elements()) {
        std::vector<std::int32_t> state = state_of(cut, element);
        std::vector<std::int32_t>& known = states_[element];
        if (state == known) continue;
        known = std::move(state);
        renewed.insert(element);
    }
    if (renewed.empty()) return false;
    for (const std::int32_t element : renewed) {
        renew(cut, element, true);
        for (const std::int32_t beside : neighbours_[static_cast<std::size_t>(element)]) {
            if (beside >= 0 && inside_) renew_face(cut, element, beside);
        }
    }

    std::set<std::int32_t> divided;  // for the first time
    for (const std::int32_t element : renewed) {
        for (const ElementPatch::Polygon& polygon : patches_.at({element, element}).shape.polygons) {
            if (polygon.triangle >= 0 && is_divided_[static_cast<std::size_t>(polygon.triangle)] == 0) {
                is_divided_[static_cast<std::size_t>(polygon.triangle)] = 1;
                divided.insert(polygon.triangle);
            }
        }
    }
    std::set<std::int32_t> beside;
    for (const std::int32_t triangle : divided) {
        element_grid_.for_each_overlap(triangle_boxes_[static_cast<std::size_t>(triangle)], [&](std::int32_t element) {
            const auto found = patches_.find({element, element});
            if (found == patches_.end() || !found->second.has_all) beside.insert(element);
        });
    }
    for (const std::int32_t element : beside) renew(cut, element, false);
    find_leaving(cut, divided);
    assemble(cut);
    return true;
}

std::vector<std::int32_t> EmbeddedSurface::triangles_near(std::int32_t element) const {
    std::vector<std::int32_t> triangles;
    triangle_grid_.for_each_overlap(element_boxes_[static_cast<std::size_t>(element)],
                                    [&](std::int32_t triangle) { triangles.push_back(triangle); });
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

void EmbeddedSurface::renew(const CutMesh& cut, std::int32_t element, bool has_all) {
    std::vector<std::int32_t> triangles = triangles_near(element);
    if (!has_all) {
        std::erase_if(triangles, [&](std::int32_t t) { return is_divided_[static_cast<std::size_t>(t)] == 0; });
    }
    Inside is_inside;
    if (has_all && inside_) is_inside = [&](const Point& place) { return inside_->contains(place); };
    replace({element, element}, element_patch(cut, element, facets_, triangles, is_inside), has_all);
}

void EmbeddedSurface::renew_face(const CutMesh& cut, std::int32_t element, std::int32_t beside) {
    const std::pair key(std::min(element, beside), std::max(element, beside));
    replace(key,
            face_patch(cut, element, beside, facets_, triangles_near(element),
                       [&](const Point& place) { return inside_->contains(place); }),
            true);
}

/// Corners that were there before keep their vertices.
void EmbeddedSurface::replace(std::pair<std::int32_t, std::int32_t> elements, ElementPatch shape, bool has_all) {
    Patch patch{.shape = std::move(shape), .has_all = has_all};
    patch.numbers.assign(patch.shape.corners.size(), -1);
    Patch& old = patches_[elements];
    std::map<std::int32_t, std::vector<std::size_t>> old_of_part;
    for (std::size_t c = 0; c < old.shape.corners.size(); ++c) old_of_part[old.shape.corners[c].part].push_back(c);
    for (std::size_t c = 0; c < patch.shape.corners.size(); ++c) {
        const ElementPatch::Corner& corner = patch.shape.corners[c];
        for (const std::size_t o : old_of_part[corner.part]) {
            double largest = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                largest = std::max(largest, std::abs(old.shape.corners[o].weights[k] - corner.weights[k]));
            }
            if (largest < same_weight) patch.numbers[c] = old.numbers[o];
        }
    }
    old = std::move(patch);
}

/// What patches of an element depend on: every cut that touches it adds planes, and one nearby may separate copies.
std::vector<std::int32_t> EmbeddedSurface::state_of(const CutMesh& cut, std::int32_t element) const {
    std::vector<std::int32_t> state{cut.cells(element)->pool().planes()};
    const auto add = [&](std::int32_t of) {
        for (const std::int32_t part : cut.parts_of_element(of)) {
            const Tetrahedron& copies = cut.parts()[static_cast<std::size_t>(part)];
            state.insert(state.end(), copies.begin(), copies.end());
        }
    };
    add(element);
    for (const std::int32_t beside : neighbours_[static_cast<std::size_t>(element)]) {
        if (beside >= 0) add(beside);
    }
    return state;
}

/// Triangles whose pieces do not cover them reach out of the mesh.
void EmbeddedSurface::find_leaving(const CutMesh& cut, const std::set<std::int32_t>& triangles) {
    std::map<std::int32_t, double> covered;
    for (const auto& [elements, patch] : patches_) {
        for (const ElementPatch::Polygon& polygon : patch.shape.polygons) {
            if (!triangles.contains(polygon.triangle)) continue;
            std::vector<Point> places;
            for (const std::int32_t corner : polygon.loops.front()) {
                const ElementPatch::Corner& at = patch.shape.corners[static_cast<std::size_t>(corner)];
                places.push_back(place_in(corners_of(cut.mesh(), elements.first), at.weights));
            }
            for (std::size_t k = 2; k < places.size(); ++k) {
                covered[polygon.triangle] += area(places[0], places[k - 1], places[k]);
            }
        }
    }
    for (const std::int32_t triangle : triangles) {
        const auto& [a, b, c] = facets_.moved().triangles[static_cast<std::size_t>(triangle)];
        const auto& x = facets_.moved().vertices;
        const double whole =
            area(x[static_cast<std::size_t>(a)], x[static_cast<std::size_t>(b)], x[static_cast<std::size_t>(c)]);
        if (covered[triangle] < whole * (1 - 1e-6)) leaves_[static_cast<std::size_t>(triangle)] = 1;
    }
}

void EmbeddedSurface::set_point(const CutMesh& cut, std::int32_t vertex, const MaterialPoint& point) {
    const auto v = static_cast<std::size_t>(vertex);
    if (points_.size() <= v) {
        points_.resize(v + 1);
        at_rest_.resize(v + 1);
    }
    const std::int32_t element = cut.element_of_part()[static_cast<std::size_t>(point.part)];
    const std::array<Point, 4> corners = corners_of(cut.mesh(), element);
    points_[v] = point;
    if (v < facets_.surface().vertices.size()) {
        points_[v].weights = barycentric(corners, facets_.surface().vertices[v]);  // not those of the moved copy
    } else {
        at_rest_[v] = place_in(corners, point.weights);
    }
}

void EmbeddedSurface::number_corners(const CutMesh& cut) {
    CornerNumbers numbers(cut);
    std::set<std::int32_t> given;
    const auto for_each_corner = [&](const auto& use) {
        for (auto& [elements, patch] : patches_) {
            for (std::size_t c = 0; c < patch.numbers.size(); ++c) use(patch.shape.corners[c], patch.numbers[c]);
        }
    };
    // First the surface's own vertices, then those that have numbers, then new ones.
    for_each_corner([&](const ElementPatch::Corner& corner, std::int32_t& number) {
        if (corner.vertex < 0) return;
        number = corner.vertex;
        if (!given.insert(number).second) return;
        numbers.add({corner.part, corner.weights}, number);
        set_point(cut, number, {corner.part, corner.weights});
    });
    for (const bool is_new : {false, true}) {
        for_each_corner([&](const ElementPatch::Corner& corner, std::int32_t& number) {
            if (corner.vertex >= 0 || (number < 0) != is_new) return;
            const MaterialPoint point{corner.part, corner.weights};
            const std::int32_t same = numbers.find(point);
            if (same >= 0) {
                number = same;
                return;
            }
            if (is_new || !given.insert(number).second) number = static_cast<std::int32_t>(points_.size());
            given.insert(number);
            numbers.add(point, number);
            set_point(cut, number, point);
        });
    }
}

std::vector<PartRegion> EmbeddedSurface::regions() const {
    std::vector<PartRegion> regions;
    for (const auto& [elements, patch] : patches_) {
        for (const ElementPatch::Polygon& polygon : patch.shape.polygons) {
            if (polygon.triangle >= 0 && leaves_[static_cast<std::size_t>(polygon.triangle)] != 0) continue;
            PartRegion& region = regions.emplace_back(PartRegion{polygon.part, polygon.triangle});
            for (const std::vector<std::int32_t>& corners : polygon.loops) {
                std::vector<std::int32_t>& loop = region.loops.emplace_back();
                for (const std::int32_t corner : corners) {
                    loop.push_back(patch.numbers[static_cast<std::size_t>(corner)]);
                }
                simplify(loop);
            }
            std::erase_if(region.loops, [](const auto& loop) { return loop.empty(); });
        }
    }
    return regions;
}

/// Triangles that no cut is near, as they are; those beside divided ones with the corners on their common edges.
void EmbeddedSurface::add_undivided(std::vector<PartRegion>& all) {
    const auto is_whole = [&](std::int32_t triangle) {
        const auto t = static_cast<std::size_t>(triangle);
        return is_divided_[t] == 0 || leaves_[t] != 0;
    };
    std::map<std::int32_t, std::set<std::int32_t>> corners_on;  // edge -> vertices, where one side is whole
    for (const auto& [elements, patch] : patches_) {
        for (std::size_t c = 0; c < patch.numbers.size(); ++c) {
            const std::int32_t edge = patch.shape.corners[c].edge;
            if (edge < 0) continue;
            const auto [a, b] = facets_.triangles_of(edge);
            if (is_whole(a) || (b >= 0 && is_whole(b))) corners_on[edge].insert(patch.numbers[c]);
        }
    }
    const TriangleMesh& surface = facets_.surface();
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (!is_whole(static_cast<std::int32_t>(t))) continue;
        const Triangle& corners = surface.triangles[t];
        const bool is_alone = std::ranges::none_of(facets_.edges_of(static_cast<std::int32_t>(t)), [&](auto edge) {
            const auto [a, b] = facets_.triangles_of(edge);
            return !is_whole(a) || (b >= 0 && !is_whole(b));
        });
        if (is_alone) {
            triangles_.push_back(corners);
            continue;
        }
        std::vector<std::int32_t> loop;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t from = corners[k], to = corners[(k + 1) % 3];
            loop.push_back(from);
            const auto found = corners_on.find(facets_.edges_of(static_cast<std::int32_t>(t))[k]);
            if (found == corners_on.end()) continue;
            const Point &x = at_rest_[static_cast<std::size_t>(from)], &y = at_rest_[static_cast<std::size_t>(to)];
            std::vector<std::pair<double, std::int32_t>> between;
            for (const std::int32_t vertex : found->second) {
                if (vertex == from || vertex == to) continue;
                const Point& z = at_rest_[static_cast<std::size_t>(vertex)];
                double along = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) along += (z[axis] - x[axis]) * (y[axis] - x[axis]);
                between.emplace_back(along, vertex);
            }
            std::sort(between.begin(), between.end());
            for (const auto& [along, vertex] : between) loop.push_back(vertex);
        }
        all.push_back({.triangle = static_cast<std::int32_t>(t), .loops = {std::move(loop)}});
    }
}

void EmbeddedSurface::assemble(const CutMesh& cut) {
    number_corners(cut);
    triangles_.clear();
    std::vector<PartRegion> all = regions();
    add_undivided(all);
    mend_loops(cut, points_, at_rest_, all);
    std::vector<Triangle> walls;
    for (PartRegion& region : all) {
        for (std::vector<std::int32_t>& loop : region.loops) simplify(loop);
        Point normal = area_vector(region.loops, at_rest_);
        if (region.triangle >= 0) {
            const auto& [a, b, c] = facets_.surface().triangles[static_cast<std::size_t>(region.triangle)];
            normal = area_vector({{a, b, c}}, at_rest_);
        }
        add_triangles(region.loops, at_rest_, normal, region.triangle >= 0 ? triangles_ : walls);
    }
    const auto has_no_area = [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
    std::erase_if(triangles_, has_no_area);
    std::erase_if(walls, has_no_area);
    is_wall_.assign(triangles_.size(), 0);
    triangles_.insert(triangles_.end(), walls.begin(), walls.end());
    is_wall_.resize(triangles_.size(), 1);

    // Copies may have become others anywhere near a cut.
    copies_.clear();
    weights_.clear();
    for (const MaterialPoint& point : points_) {
        copies_.push_back(cut.parts()[static_cast<std::size_t>(point.part)]);
        weights_.push_back(point.weights);
    }
    ++version_;
}

}  // namespace lancet::mesh
