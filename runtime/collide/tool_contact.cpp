#include "lancet/runtime/collide/tool_contact.hpp"

#include <algorithm>
#include <optional>

namespace lancet::runtime {
namespace {

enum class Side { none, front, behind };

/// How a tool at one pose lies to one triangle.
struct Touch {
    Side side = Side::none;
    ToolContact contact{};
    bool is_interior = true;  ///< of the triangle, not of an edge or corner
    std::size_t segment = 0;
    double parameter = 0;  ///< of the point of the axis
};

struct Face {
    TrianglePoints corners;
    Point normal;
};

Face face_of(std::span<const Point> positions, const mesh::Triangle& triangle) {
    Face face{};
    for (std::size_t corner = 0; corner < 3; ++corner) face.corners[corner] = positions[triangle[corner]];
    face.normal = unit_normal(face.corners);
    return face;
}

Touch touch_of(const Segment& segment, double radius, const Face& face) {
    Touch touch;
    const SegmentTriangle closest = closest_points(segment, face.corners);
    ToolContact& contact = touch.contact;
    if (closest.pierces) {
        const double start = dot(face.normal, subtract(segment.start, face.corners[0]));
        const double end = dot(face.normal, subtract(segment.end, face.corners[0]));
        touch.side = Side::behind;
        touch.parameter = start < end ? 0 : 1;
        contact.weights = closest_point(face.corners, segment.at(touch.parameter)).weights;
        contact.normal = face.normal;
        contact.depth = radius - std::min(start, end);
        return touch;
    }
    const double distance = closest.point.distance;
    if (!(distance < radius)) return touch;
    const Point d = subtract(segment.at(closest.parameter), weighted(face.corners, closest.point.weights));
    const double above = dot(face.normal, d);
    // With the axis on an edge, to rounding, the direction between them means nothing.
    const bool is_interior = closest.point.is_interior() || distance < 1e-10 * radius;
    if (!is_interior && above == 0) return touch;
    touch.side = above < 0 ? Side::behind : Side::front;
    touch.is_interior = is_interior;
    touch.parameter = closest.parameter;
    contact.weights = closest.point.weights;
    contact.normal = is_interior ? face.normal : direction(above < 0 ? scale(d, -1) : d);
    contact.depth = is_interior ? radius - above : radius - std::copysign(distance, above);
    contact.share = is_interior ? 1 : std::abs(above) / distance;
    return touch;
}

/// The deepest of a tool's touches at one pose, of the segments that are near the triangle; takes them off `near`.
template <class Near>
Touch deepest_touch(std::span<const Near>& near, const ToolMotion& motion, const Face& face) {
    Touch deepest;
    const std::int32_t pose = near.front().pose;
    for (; !near.empty() && near.front().pose == pose; near = near.subspan(1)) {
        const auto segment = static_cast<std::size_t>(near.front().segment);
        Touch touch = touch_of(motion.axis(static_cast<std::size_t>(pose))[segment], motion.radius(), face);
        if (touch.side == Side::none || !(touch.contact.depth > deepest.contact.depth)) continue;
        touch.segment = segment;
        deepest = touch;
    }
    return deepest;
}

bool has(const mesh::Triangle& triangle, std::int32_t node) {
    return triangle[0] == node || triangle[1] == node || triangle[2] == node;
}

/// Whether a point of the axis is behind all triangles at the edge or corner that a contact is on, none of them is
/// nearer, and none that is as near comes before. They all are candidates, being as near as the contact's own.
bool is_nearest_behind(const Point& on_axis, const ToolContact& contact, std::span<const std::int32_t> candidates,
                       std::span<const mesh::Triangle> triangles, std::span<const Point> positions) {
    const mesh::Triangle& own = triangles[static_cast<std::size_t>(contact.triangle)];
    const Point d = subtract(on_axis, contact.place);
    const double not_nearer = length(d) * (1 - 1e-9);
    for (const std::int32_t candidate : candidates) {
        if (candidate == contact.triangle) continue;
        const mesh::Triangle& other = triangles[static_cast<std::size_t>(candidate)];
        bool is_there = true;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            is_there = is_there && (contact.weights[corner] == 0 || has(other, own[corner]));
        }
        if (!is_there) continue;
        const Face face = face_of(positions, other);
        if (face.normal == Point{}) continue;
        const TrianglePoint closest = closest_point(face.corners, on_axis);
        if (closest.is_interior() || closest.distance < not_nearer || candidate < contact.triangle) return false;
        if (dot(face.normal, d) > 0) return false;
    }
    return true;
}

/// How the tool lies to the face at its end, or where it crossed the face from the front on its way and is behind it at
/// the end. `near`: by pose.
template <class Near>
Touch end_or_crossing(std::span<const Near> near, const ToolMotion& motion, const Face& face) {
    Touch crossed;
    bool was_in_front = false;
    while (!near.empty()) {
        const bool is_end = static_cast<std::size_t>(near.front().pose) + 1 == motion.poses();
        const Touch touch = deepest_touch(near, motion, face);
        if (is_end && touch.side != Side::none) return touch;
        if (touch.side == Side::front) {
            was_in_front = true;
            crossed = {};
        } else if (touch.side == Side::behind && touch.is_interior && was_in_front && crossed.side == Side::none) {
            crossed = touch;
        }
    }
    if (crossed.side == Side::none) return crossed;
    const Point a = motion.end()[crossed.segment].at(crossed.parameter);
    const double above = dot(face.normal, subtract(a, face.corners[0]));
    if (!(above < 0)) return {};
    crossed.contact.depth = motion.radius() - above;
    return crossed;
}

}  // namespace

void ToolContactFinder::find(const BroadPhase& surface, std::span<const Point> positions,
                             std::span<const mesh::Triangle> triangles, const ToolMotion& motion,
                             std::vector<ToolContact>& contacts) {
    near_.clear();
    for (std::size_t pose = 0; pose < motion.poses(); ++pose) {
        const std::span<const Segment> axis = motion.axis(pose);
        for (std::size_t segment = 0; segment < axis.size(); ++segment) {
            const std::array ends{axis[segment].start, axis[segment].end};
            surface.query(box_around(ends, motion.radius()), found_);
            for (const std::int32_t triangle : found_) {
                near_.push_back({triangle, static_cast<std::int32_t>(pose), static_cast<std::int32_t>(segment)});
            }
        }
    }
    std::ranges::sort(near_);
    candidates_.clear();
    for (const Near& near : near_) {
        if (candidates_.empty() || candidates_.back() != near.triangle) candidates_.push_back(near.triangle);
    }

    contacts.clear();
    std::span<const Near> rest(near_);
    for (const std::int32_t number : candidates_) {
        const auto last = std::ranges::find_if(rest, [&](const Near& near) { return near.triangle != number; });
        const std::span<const Near> near(rest.begin(), last);
        rest = {last, rest.end()};
        const Face face = face_of(positions, triangles[static_cast<std::size_t>(number)]);
        if (face.normal == Point{}) continue;
        Touch touch = end_or_crossing(near, motion, face);
        if (touch.side == Side::none) continue;
        touch.contact.triangle = number;
        touch.contact.place = weighted(face.corners, touch.contact.weights);
        if (touch.side == Side::behind && !touch.is_interior) {
            const Point on_axis = motion.end()[touch.segment].at(touch.parameter);
            if (!is_nearest_behind(on_axis, touch.contact, candidates_, triangles, positions)) continue;
        }
        contacts.push_back(touch.contact);
    }
}

}  // namespace lancet::runtime
