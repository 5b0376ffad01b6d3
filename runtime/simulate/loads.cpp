#include "lancet/runtime/simulate/loads.hpp"

#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

namespace {

class Loads {
  public:
    explicit Loads(const mesh::TetMesh& mesh) : positions_(mesh.nodes()), loads_(positions_.size(), Point{}) {}

    void add(const std::string& what, std::int32_t node, const Point& force, double share) {
        require_node(what, node);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!std::isfinite(force[axis])) throw Error(what + ": the force is not finite");
            loads_[static_cast<std::size_t>(node)][axis] += share * force[axis];
        }
    }

    /// b - a for two nodes.
    Point edge(const std::string& what, std::int32_t a, std::int32_t b) const {
        require_node(what, a);
        require_node(what, b);
        const Point &from = positions_[static_cast<std::size_t>(a)], &to = positions_[static_cast<std::size_t>(b)];
        return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    }

    std::vector<Point> take() { return std::move(loads_); }

    void require_node(const std::string& what, std::int32_t node) const {
        if (node >= 0 && static_cast<std::size_t>(node) < positions_.size()) return;
        throw Error(what + ": node " + std::to_string(node) + " does not exist; the mesh has nodes 0 to " +
                    std::to_string(static_cast<std::int64_t>(positions_.size()) - 1));
    }

  private:
    std::span<const Point> positions_;
    std::vector<Point> loads_;
};

}  // namespace

std::vector<Point> external_loads(const Scene& scene) {
    Loads loads(scene.mesh);
    for (std::size_t k = 0; k < scene.nodal_loads.size(); ++k) {
        const NodalLoad& load = scene.nodal_loads[k];
        loads.add("nodal load " + std::to_string(k), load.node, load.force, 1);
    }
    for (std::size_t k = 0; k < scene.edge_loads.size(); ++k) {
        const auto& [nodes, force] = scene.edge_loads[k];
        const std::string what = "edge load " + std::to_string(k);
        const Point along = loads.edge(what, nodes[0], nodes[1]);
        const double length = std::hypot(along[0], along[1], along[2]);
        if (!(length > 0)) throw Error(what + ": the edge has no length");
        for (const std::int32_t node : nodes) loads.add(what, node, force, length / 2);
    }
    for (std::size_t k = 0; k < scene.tractions.size(); ++k) {
        const auto& [triangles, force] = scene.tractions[k];
        const std::string what = "traction " + std::to_string(k);
        for (const mesh::Triangle& triangle : triangles) {
            for (const std::int32_t node : triangle) loads.require_node(what, node);
            const auto nodes = scene.mesh.nodes();
            const double area = mesh::area(nodes[triangle[0]], nodes[triangle[1]], nodes[triangle[2]]);
            if (!(area > 0)) {
                throw Error(what + ": triangle " + std::to_string(triangle[0]) + ", " + std::to_string(triangle[1]) +
                            ", " + std::to_string(triangle[2]) + " has no area");
            }
            for (const std::int32_t node : triangle) loads.add(what, node, force, area / 3);
        }
    }
    return loads.take();
}

}  // namespace lancet::runtime
