#include "lancet/runtime/collide/vertex_contact.hpp"

#include <algorithm>
#include <optional>

#include "lancet/runtime/collide/closest.hpp"

namespace lancet::runtime {
namespace {

/// Weights below are zero to rounding, and depths below so much of an edge.
constexpr double rounding = 1e-10;

constexpr int unknown = -1;

template <class Primitive>
bool has(const Primitive& primitive, std::int32_t node) {
    return std::ranges::find(primitive, node) != primitive.end();
}

/// The contact of a vertex with the first tetrahedron that contains it, without depth. The pairs are all of the vertex.
std::optional<VertexContact> vertex_contact(const CollidableBody& first, const CollidableBody& second,
                                            std::span<const BoxPair> pairs) {
    const bool is_self = &first == &second;
    std::optional<VertexContact> contact;
    for (const BoxPair& pair : pairs) {
        const mesh::Tetrahedron& element = second.tetrahedra()[static_cast<std::size_t>(pair.first)];
        if (is_self && has(element, pair.second)) continue;
        std::array<Point, 4> corners;
        for (std::size_t corner = 0; corner < 4; ++corner) corners[corner] = second.positions()[element[corner]];
        const std::array<double, 4> weights =
            mesh::barycentric(corners, first.positions()[static_cast<std::size_t>(pair.second)]);
        // Within a body, vertices on the faces of others are the walls of a cut that has not opened, or lie so at rest.
        // Of another body, they collide if the faces are inside of it. False where weights are not numbers.
        const double smallest = is_self ? rounding : -rounding;
        if (!std::ranges::all_of(weights, [&](double weight) { return weight > smallest; })) continue;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if (weights[corner] <= rounding && second.is_on_surface(pair.first, corner)) return std::nullopt;
        }
        if (!contact) contact = VertexContact{pair.second, pair.first, weights};
    }
    return contact;
}

/// The parameter at which a segment passes to the back of a triangle, edges included: a segment that leads through an
/// edge must not slip between its triangles.
std::optional<double> entry(const Segment& segment, const TrianglePoints& corners, const Point& normal) {
    const double start = dot(normal, subtract(segment.start, corners[0]));
    const double end = dot(normal, subtract(segment.end, corners[0]));
    if (!(start >= 0 && end < 0)) return std::nullopt;
    const double parameter = start / (start - end);
    const Point place = segment.at(parameter);
    const TrianglePoint closest = closest_point(corners, place);
    const double size = length(subtract(corners[1], corners[0])) + length(subtract(corners[2], corners[0]));
    if (!(closest.distance <= 1e-2 * rounding * (size + length(subtract(segment.end, segment.start)))))
        return std::nullopt;
    return parameter;
}

}  // namespace

void VertexContactFinder::find(Scheduler& scheduler, const CollidableBody& first, const CollidableBody& second,
                               std::vector<VertexContact>& contacts) {
    find_vertices(scheduler, first, second, contacts);
    enter_surface(first, second, contacts);
    propagate(first, contacts);
    const std::size_t colliding = contacts.size();
    // Contacts whose depth is unknown have normal zero.
    std::erase_if(contacts,
                  [](const VertexContact& contact) { return !(contact.depth > 0) || contact.normal == Point{}; });
    unresolved_ = colliding - contacts.size();
}

void VertexContactFinder::find_vertices(Scheduler& scheduler, const CollidableBody& first, const CollidableBody& second,
                                        std::vector<VertexContact>& contacts) {
    second.tetrahedron_boxes().pairs(scheduler, first.node_boxes(), pairs_);
    contacts.clear();
    contact_of_.assign(first.positions().size(), unknown);
    // Pairs come by vertex.
    for (std::size_t begin = 0, end = 0; begin < pairs_.size(); begin = end) {
        const std::int32_t vertex = pairs_[begin].second;
        for (end = begin; end < pairs_.size() && pairs_[end].second == vertex;) ++end;
        const auto contact = vertex_contact(first, second, std::span(pairs_).subspan(begin, end - begin));
        if (!contact) continue;
        contact_of_[vertex] = static_cast<std::int32_t>(contacts.size());
        contacts.push_back(*contact);
    }
}

void VertexContactFinder::enter_surface(const CollidableBody& first, const CollidableBody& second,
                                        std::vector<VertexContact>& contacts) {
    const bool is_self = &first == &second;
    sums_.assign(contacts.size(), {});
    level_.assign(contacts.size(), unknown);
    for (const auto& [a, b] : first.edges()) {
        if ((contact_of_[a] == unknown) == (contact_of_[b] == unknown)) continue;
        const std::int32_t inside = contact_of_[a] == unknown ? b : a, outside = inside == a ? b : a;
        const Segment edge{first.positions()[outside], first.positions()[inside]};
        second.surface_boxes().query(box_around(std::array{edge.start, edge.end}), triangles_);
        double nearest = 2;
        Point normal{};
        for (const std::int32_t number : triangles_) {
            const mesh::Triangle& triangle = second.surface()[static_cast<std::size_t>(number)];
            if (is_self && (has(triangle, a) || has(triangle, b))) continue;
            TrianglePoints corners;
            for (std::size_t corner = 0; corner < 3; ++corner) corners[corner] = second.positions()[triangle[corner]];
            const Point candidate = unit_normal(corners);
            if (candidate == Point{}) continue;
            // Of several, the one nearest to the vertex outside, as the paper has it.
            const auto parameter = entry(edge, corners, candidate);
            if (!parameter || !(*parameter < nearest)) continue;
            nearest = *parameter;
            normal = candidate;
        }
        if (nearest > 1) continue;
        const Point way = subtract(edge.at(nearest), edge.end), whole = subtract(edge.start, edge.end);
        // A vertex just below the surface: its other edges count for nothing then, but numbers stay finite.
        const double weight = 1 / std::max(dot(way, way), 1e-24 * dot(whole, whole));
        const auto contact = static_cast<std::size_t>(contact_of_[inside]);
        Sums& sums = sums_[contact];
        sums.weight += weight;
        sums.depth += weight * dot(way, normal);
        sums.normal = add_scaled(sums.normal, weight, normal);
        level_[contact] = 0;
    }
    for (std::size_t contact = 0; contact < contacts.size(); ++contact) {
        if (level_[contact] == unknown) continue;
        contacts[contact].depth = sums_[contact].depth / sums_[contact].weight;
        contacts[contact].normal = direction(sums_[contact].normal);
    }
}

void VertexContactFinder::propagate(const CollidableBody& first, std::vector<VertexContact>& contacts) {
    bool is_growing = true;
    for (int level = 1; is_growing; ++level) {
        is_growing = false;
        for (std::size_t contact = 0; contact < contacts.size(); ++contact) {
            if (level_[contact] != unknown) continue;
            const Point& p = first.positions()[static_cast<std::size_t>(contacts[contact].vertex)];
            Sums sums;
            for (const std::int32_t neighbour : first.neighbours(contacts[contact].vertex)) {
                const std::int32_t known = contact_of_[neighbour];
                if (known == unknown || level_[known] == unknown || level_[known] >= level) continue;
                const Point way = subtract(first.positions()[static_cast<std::size_t>(neighbour)], p);
                const double squared = dot(way, way);
                if (!(squared > 0)) continue;
                sums.weight += 1 / squared;
                sums.depth += (dot(way, contacts[known].normal) + contacts[known].depth) / squared;
                sums.normal = add_scaled(sums.normal, 1 / squared, contacts[known].normal);
            }
            if (!(sums.weight > 0)) continue;
            contacts[contact].depth = sums.depth / sums.weight;
            contacts[contact].normal = direction(sums.normal);
            level_[contact] = level;
            is_growing = true;
        }
    }
}

}  // namespace lancet::runtime
