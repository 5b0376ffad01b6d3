#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"

namespace lancet::mesh {

/// The line in an element along which its cuts end inside of the body: edges of their sections behind which no section
/// goes on, neither here nor in the neighbour, and where no other cut is met. Places are told apart at 1e-9 of the
/// element: this is for what is drawn.
class FrontLine {
  public:
    FrontLine(const CutMesh& cut, std::int32_t element);

    /// Whether a place lies on it.
    bool holds(const Barycentric& place) const;

  private:
    std::vector<std::array<Barycentric, 2>> edges_;
};

}  // namespace lancet::mesh
