#include "lancet/runtime/cut/motion_after_cut.hpp"

#include <algorithm>

namespace lancet::runtime {

std::int32_t BodyBeforeCut::opening_from(std::int32_t copy) const {
    const auto found = std::ranges::lower_bound(opened_from, copy);
    if (found == opened_from.end() || *found != copy) return -1;
    return copies + static_cast<std::int32_t>(found - opened_from.begin());
}

std::vector<DeformableBody::NodeMotion> motion_after_cut(const BodyBeforeCut& before, const mesh::CutMesh& cut,
                                                         std::span<const std::int32_t> opened_from,
                                                         const std::function<double(std::int32_t node)>& mass) {
    const auto copies = static_cast<std::int32_t>(cut.node_of_copy().size());
    const auto nodes = copies + static_cast<std::int32_t>(opened_from.size());
    std::vector<DeformableBody::NodeMotion> motions;
    // A parent has a lower number: its motion is there before that of its copy is asked for.
    for (std::int32_t node = before.copies; node < nodes; ++node) {
        const std::int32_t parent = node < copies ? cut.parent_of_copy()[static_cast<std::size_t>(node)]
                                                  : opened_from[static_cast<std::size_t>(node - copies)];
        DeformableBody::NodeMotion motion = parent < before.copies
                                                ? before.body->motion(parent)
                                                : motions[static_cast<std::size_t>(parent - before.copies)];
        if (const std::int32_t opening = before.opening_from(parent); opening >= 0) {
            const DeformableBody::NodeMotion opened = before.body->motion(opening);
            const double now = mass(node);
            const double kept = now > 0 ? std::min(1.0, before.body->nodal_mass(opening) / now) : 1.0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                motion.velocity[axis] = kept * opened.velocity[axis] + (1 - kept) * motion.velocity[axis];
            }
            motion.position = opened.position;
        }
        motions.push_back(motion);
    }
    return motions;
}

}  // namespace lancet::runtime
