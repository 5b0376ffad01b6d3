#include "lancet/runtime/simulate/floating.hpp"

#include <algorithm>

#include <Eigen/Dense>

#include "lancet/mesh/components.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"

namespace lancet::runtime {

std::vector<FloatingComponent> floating_components(const Scene& scene) {
    using Motions = Eigen::Matrix<double, 6, 6>;
    validate_constraints(scene);
    const mesh::Components parts = mesh::components(scene.mesh);
    const std::span<const mesh::Point> nodes = scene.mesh.nodes();
    const auto count = static_cast<std::size_t>(parts.count);
    std::vector<FloatingComponent> components(count, {0, 0, -1, 6});
    std::vector<Eigen::Vector3d> centre(count, Eigen::Vector3d::Zero());
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        const auto part = static_cast<std::size_t>(parts.of_node[node]);
        centre[part] += Eigen::Map<const Eigen::Vector3d>(nodes[node].data());
        if (components[part].nodes++ == 0) components[part].first_node = static_cast<std::int32_t>(node);
    }
    std::vector<double> size(count, 0.0);
    for (std::size_t part = 0; part < count; ++part) centre[part] /= std::max(components[part].nodes, 1);
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        const auto part = static_cast<std::size_t>(parts.of_node[node]);
        size[part] =
            std::max(size[part], (Eigen::Map<const Eigen::Vector3d>(nodes[node].data()) - centre[part]).norm());
    }
    // A held component of a node's displacement is a row of (t + w x r): the motions that are left are the null space.
    std::vector<Motions> held(count, Motions::Zero());
    const auto hold = [&](std::int32_t node, int axis) {
        const auto part = static_cast<std::size_t>(parts.of_node[static_cast<std::size_t>(node)]);
        const Eigen::Vector3d r =
            (Eigen::Map<const Eigen::Vector3d>(nodes[static_cast<std::size_t>(node)].data()) - centre[part]) /
            std::max(size[part], 1e-300);
        Eigen::Matrix<double, 6, 1> row;
        row << Eigen::Vector3d::Unit(axis), r.cross(Eigen::Vector3d::Unit(axis));
        held[part] += row * row.transpose();
    };
    for (const std::int32_t node : scene.fixed_nodes) {
        for (int axis = 0; axis < 3; ++axis) hold(node, axis);
    }
    for (const PrescribedDisplacement& prescribed : scene.prescribed) hold(prescribed.node, prescribed.axis);

    std::vector<FloatingComponent> floating;
    for (std::size_t part = 0; part < count; ++part) {
        const Eigen::SelfAdjointEigenSolver<Motions> motions(held[part], Eigen::EigenvaluesOnly);
        components[part].component = static_cast<std::int32_t>(part);
        // The rows have lengths of order one: what is held at all has an eigenvalue far above rounding.
        constexpr double rounding = 1e-12;
        components[part].free_motions = static_cast<int>(
            (motions.eigenvalues().array() <= rounding * std::max(1.0, motions.eigenvalues().maxCoeff())).count());
        if (components[part].free_motions > 0) floating.push_back(components[part]);
    }
    return floating;
}

}  // namespace lancet::runtime
