#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/runtime/cut/divided_elements.hpp"
#include "lancet/runtime/simulate/body_change.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"
#include "lancet/runtime/solve/mass_kind.hpp"

namespace lancet::runtime {

/// What the lanes of a body with cuts weigh.
class DividedInertia {
  public:
    /// Throws as element_materials does.
    DividedInertia(const Scene& scene, MassKind kind) : kind_(kind), materials_(element_materials(scene)) {}

    /// The mass of a node, with its row where the mass is consistent; nodes are numbered as in the body.
    BodyChange::NodalMass nodal_mass(const mesh::CutMesh& cut, const DividedElements& elements, CopyName name) const;
    /// A lane as an element of the body.
    BodyChange::Element element(const mesh::CutMesh& cut, const DividedElements& elements,
                                const DividedElements::Change& change) const;

  private:
    double whole_mass(const mesh::CutMesh& cut, std::int32_t element) const;

    MassKind kind_;
    ElementMaterials materials_;
};

}  // namespace lancet::runtime
