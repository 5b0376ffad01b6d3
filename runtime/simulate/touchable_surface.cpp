#include "lancet/runtime/simulate/touchable_surface.hpp"

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

}  // namespace

void TouchableSurface::update(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes) {
    surface.vertices.place(scheduler, nodes, positions_);
    box_ = runtime::box_around(positions_);
    boxes_are_old_ = true;
}

void TouchableSurface::update_boxes(const CarriedSurface& surface) {
    boxes_.resize(surface.triangles.size());
    for (std::size_t triangle = 0; triangle < boxes_.size(); ++triangle) {
        const auto& [a, b, c] = surface.triangles[triangle];
        boxes_[triangle] = runtime::box_around(std::array{positions_[static_cast<std::size_t>(a)],
                                                          positions_[static_cast<std::size_t>(b)],
                                                          positions_[static_cast<std::size_t>(c)]});
    }
    if (version_ == surface.version) {
        triangles_near_->refit(boxes_);
    } else {
        triangles_near_->build(boxes_);
        version_ = surface.version;
    }
    boxes_are_old_ = false;
}

std::span<const ToolContact> TouchableSurface::contacts(const CarriedSurface& surface, const ToolMotion& motion) {
    // A box that is not valid, of a vertex that is not finite, says nothing.
    if (is_valid(box_) && !touch(box_, box_around(motion))) return {};
    if (boxes_are_old_) update_boxes(surface);
    finder_.find(*triangles_near_, positions_, surface.triangles, motion, contacts_);
    return contacts_;
}

}  // namespace lancet::runtime
