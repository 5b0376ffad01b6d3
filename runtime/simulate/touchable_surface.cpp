#include "lancet/runtime/simulate/touchable_surface.hpp"

#include <algorithm>
#include <array>

namespace lancet::runtime {

namespace {

/// Around all that a tool passes on its way.
Box box_around(const ToolMotion& motion) {
    Box box = empty_box;
    for (std::size_t pose = 0; pose < motion.poses(); ++pose) {
        for (const Segment& segment : motion.axis(pose)) {
            box = unite(box, runtime::box_around(std::array{segment.start, segment.end}, motion.radius()));
        }
    }
    return box;
}

/// The sides of a box beyond which a point lies, a bit for each. A triangle with all corners beyond one of them has a
/// box that does not touch this one.
std::uint8_t sides_beyond(const Box& box, const Point& point) {
    unsigned sides = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sides |= (point[axis] < box.lower[axis] ? 1U : 0U) << 2 * axis;
        sides |= (point[axis] > box.upper[axis] ? 2U : 0U) << 2 * axis;
    }
    return static_cast<std::uint8_t>(sides);
}

/// Whether all points lie beyond one side of a box. Most that do not are found out by the first few.
bool is_all_beyond(const Box& box, std::span<const Point> points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double lower = box.lower[axis], upper = box.upper[axis];
        if (std::ranges::all_of(points, [&](const Point& point) { return point[axis] < lower; })) return true;
        if (std::ranges::all_of(points, [&](const Point& point) { return point[axis] > upper; })) return true;
    }
    return false;
}

}  // namespace

void TouchableSurface::update(std::span<const Point> positions) {
    positions_ = positions;
}

void TouchableSurface::find_near(const CarriedSurface& surface, const Box& box) {
    if (version_ != surface.version) {
        // Room for all triangles at once: later calls allocate nothing.
        numbers_.reserve(surface.triangles.size());
        near_.reserve(surface.triangles.size());
        boxes_.assign(surface.triangles.size(), empty_box);
        boxes_near_->build(boxes_);
        version_ = surface.version;
    }
    sides_.resize(positions_.size());
    for (std::size_t vertex = 0; vertex < positions_.size(); ++vertex) {
        sides_[vertex] = sides_beyond(box, positions_[vertex]);
    }
    numbers_.clear();
    near_.clear();
    const auto sides = [&](std::int32_t vertex) { return sides_[static_cast<std::size_t>(vertex)]; };
    for (std::size_t number = 0; number < surface.triangles.size(); ++number) {
        const mesh::Triangle& triangle = surface.triangles[number];
        if ((sides(triangle[0]) & sides(triangle[1]) & sides(triangle[2])) != 0) continue;
        numbers_.push_back(static_cast<std::int32_t>(number));
        near_.push_back(triangle);
    }
    boxes_.resize(near_.size());
    boxes_around<mesh::Triangle>(positions_, near_, 0, boxes_);
    boxes_near_->build(boxes_);
}

std::span<const ToolContact> TouchableSurface::contacts(const CarriedSurface& surface, const ToolMotion& motion) {
    Box box = box_around(motion);
    if (is_all_beyond(box, positions_)) return {};
    // Wider by what counts as zero for the broad phase.
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] -= smallest_coordinate;
        box.upper[axis] += smallest_coordinate;
    }
    find_near(surface, box);
    finder_.find(*boxes_near_, positions_, near_, motion, contacts_);
    for (ToolContact& contact : contacts_) contact.triangle = numbers_[static_cast<std::size_t>(contact.triangle)];
    return contacts_;
}

}  // namespace lancet::runtime
