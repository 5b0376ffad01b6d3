#include "lancet/mesh/cut/front_blend.hpp"

#include "lancet/mesh/cut/front_opening.hpp"

namespace lancet::mesh {

Point CopyWeights::place(std::span<const Point> positions) const {
    Point at{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        const Point& x = positions[static_cast<std::size_t>(copies[i])];
        for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += weights[i] * x[axis];
    }
    return at;
}

FrontBlend::FrontBlend(const CutMesh& cut, Fronts fronts) {
    if (fronts == Fronts::blended) openings_ = FrontOpening(cut).openings();
}

const PartOpening* FrontBlend::opening(std::int32_t part) const {
    const auto found = openings_.find(part);
    return found == openings_.end() ? nullptr : &found->second;
}

CopyWeights FrontBlend::hold(const CutMesh& cut, const MaterialPoint& point) const {
    const PartOpening* opening = this->opening(point.part);
    return hold(cut, point, opening != nullptr && opening->guide_at(point.weights) < 0 ? -1 : 1);
}

CopyWeights FrontBlend::hold(const CutMesh& cut, const MaterialPoint& point, int side) const {
    const PartOpening* opening = this->opening(point.part);
    const Tetrahedron& copies = cut.parts()[static_cast<std::size_t>(point.part)];
    CopyWeights result;
    for (std::size_t k = 0; k < 4; ++k) {
        const PartOpening::Corner corner = opening == nullptr ? PartOpening::Corner{} : opening->corners[k];
        const double beyond = side == corner.near_side ? 0 : side == 0 ? 0.5 : 1;
        const double far_share = beyond * corner.openness;
        result.add(copies[k], (1 - far_share) * point.weights[k]);
        result.add(corner.far, far_share * point.weights[k]);
    }
    return result;
}

}  // namespace lancet::mesh
