#include "lancet/runtime/collide/bounding_volume_tree.hpp"
#include "lancet/runtime/collide/broad_phase_kinds.hpp"

namespace lancet::runtime {
namespace {

struct BoxVolume {
    Box box = empty_box;

    static BoxVolume around(const Box& box) noexcept { return {box}; }
    static BoxVolume merged(const BoxVolume& a, const BoxVolume& b) noexcept { return {unite(a.box, b.box)}; }
    bool touches(const Box& other) const noexcept { return touch(box, other); }
};

class AabbTree final : public BoundingVolumeTree<BoxVolume> {
  public:
    BroadPhaseKind kind() const noexcept override { return BroadPhaseKind::aabb_tree; }
};

}  // namespace

std::unique_ptr<BroadPhase> make_aabb_tree() {
    return std::make_unique<AabbTree>();
}

}  // namespace lancet::runtime
