#include "lancet/runtime/simulate/touchable_surface.hpp"

#include <array>

namespace lancet::runtime {

void TouchableSurface::update(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes) {
    place(scheduler, surface.vertices, nodes, positions_);
    boxes_.resize(surface.triangles.size());
    for (std::size_t triangle = 0; triangle < boxes_.size(); ++triangle) {
        const auto& [a, b, c] = surface.triangles[triangle];
        boxes_[triangle] =
            box_around(std::array{positions_[static_cast<std::size_t>(a)], positions_[static_cast<std::size_t>(b)],
                                  positions_[static_cast<std::size_t>(c)]});
    }
    if (version_ == surface.version) {
        triangles_near_->refit(boxes_);
    } else {
        triangles_near_->build(boxes_);
        version_ = surface.version;
    }
}

std::span<const ToolContact> TouchableSurface::contacts(const CarriedSurface& surface, const ToolMotion& motion) {
    finder_.find(*triangles_near_, positions_, surface.triangles, motion, contacts_);
    return contacts_;
}

}  // namespace lancet::runtime
