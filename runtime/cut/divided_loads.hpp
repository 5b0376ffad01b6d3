#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// The dead loads of a scene on the copies of a cut mesh. Loads act on the material: what lies on an edge or a triangle
/// goes to the parts there, and a force on a node to the copy that holds the node.
class DividedLoads {
  public:
    /// Throws lancet::Error as external_loads does, for the scene without cuts.
    DividedLoads(const Scene& scene, const mesh::CutMesh& cut);

    /// Takes up a cut; `elements` are those whose parts or copies it changed. The work is proportional to the loads on
    /// them, but for one look at each load.
    void update(const mesh::CutMesh& cut, std::span<const std::int32_t> elements);

    bool empty() const noexcept { return forces_.empty(); }
    /// Every copy that takes a force, some several times.
    std::span<const NodalLoad> on_copies() const noexcept { return forces_; }

  private:
    /// A force on an edge or a triangle.
    struct Piece {
        std::int32_t element = -1;  ///< that has all its nodes, the first where there are several; -1: none
        int nodes = 0;
        mesh::Triangle node{};
        mesh::Point force{};
        std::vector<NodalLoad> forces{};
    };
    void add_piece(const mesh::CutMesh& cut, std::span<const std::int32_t> nodes, const mesh::Point& force);
    static void spread(const mesh::CutMesh& cut, Piece& piece);
    void collect();

    std::vector<NodalLoad> on_nodes_;
    std::vector<Piece> pieces_;  ///< by element
    std::vector<NodalLoad> forces_;
};

}  // namespace lancet::runtime
