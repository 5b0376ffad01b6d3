#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::runtime {

/// What a body with cuts was before a cut.
struct BodyBeforeCut {
    const DeformableBody* body = nullptr;
    std::int32_t copies = 0;                    ///< of its cut mesh; its further nodes are those that open
    std::span<const std::int32_t> opened_from;  ///< see mesh::Lanes

    /// The node that was opening from a copy, -1 where none was.
    std::int32_t opening_from(std::int32_t copy) const;
};

/// The motion of the nodes from before.copies on, after a cut. A new copy starts where the one is that it was separated
/// from, and with its velocity; where one was opening from that, the new one goes on from there. What has come over to
/// it since brings the velocity of where it came from, which keeps linear momentum.
/// - mass: of a node after the cut, kilograms
std::vector<DeformableBody::NodeMotion> motion_after_cut(const BodyBeforeCut& before, const mesh::CutMesh& cut,
                                                         std::span<const std::int32_t> opened_from,
                                                         const std::function<double(std::int32_t node)>& mass);

}  // namespace lancet::runtime
