#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// What makes one body of another that differs from it by some elements and nodes. Nodes are numbered as in the body
/// that it becomes, elements by numbers that they keep.
struct BodyChange {
    struct Node {
        std::int32_t before = -1;  ///< its number so far; -1: it is new
        mesh::Point rest{};
        bool is_fixed = false;
        mesh::Point position{}, velocity{};  ///< of old nodes, too
    };
    struct Element {
        std::int32_t element = 0;
        bool is_there = true;
        kernels::Tetrahedron nodes{};
        std::int32_t like = -1;  ///< an old element from whose rotation a new one starts
        kernels::ElasticParameters material{};
        double fraction = 1;                  ///< of its volume
        std::array<double, 6> pair_masses{};  ///< for a consistent mass
    };
    struct NodalMass {
        std::int32_t node = 0;
        double mass = 0;                                     ///< row sum, kilograms
        std::vector<std::pair<std::int32_t, double>> row{};  ///< for a consistent mass: those with other nodes
    };

    std::int32_t first_node = 0;  ///< nodes before it stay what they are
    std::vector<Node> nodes{};    ///< all from there on
    std::vector<Element> elements{};
    std::vector<NodalMass> masses{};                   ///< of all nodes of elements that have changed
    std::vector<PrescribedDisplacement> prescribed{};  ///< of new nodes
};

}  // namespace lancet::runtime
