#include "lancet/runtime/simulate/surface.hpp"

#include <algorithm>

#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/cut/part_geometry.hpp"

namespace lancet::runtime {

namespace {

constexpr std::size_t vertices_per_block = 1024;

template <class Body>
void for_each_block_of_vertices(Scheduler& scheduler, std::size_t vertices, const Body& body) {
    const auto blocks = static_cast<int>((vertices + vertices_per_block - 1) / vertices_per_block);
    scheduler.for_each_block(blocks, [&](int block) {
        const std::size_t begin = static_cast<std::size_t>(block) * vertices_per_block;
        body(begin, std::min(vertices, begin + vertices_per_block));
    });
}

}  // namespace

CarriedSurface boundary_surface(const mesh::TetMesh& mesh) {
    CarriedSurface surface;
    std::vector<std::int32_t> vertex_of_node(mesh.nodes().size(), -1);
    const mesh::Boundary boundary = mesh::boundary(mesh);
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
        mesh::Triangle triangle = boundary.triangles[t];
        const mesh::Tetrahedron& nodes = mesh.tetrahedra()[static_cast<std::size_t>(boundary.elements[t])];
        for (std::int32_t& corner : triangle) {
            std::int32_t& vertex = vertex_of_node[static_cast<std::size_t>(corner)];
            if (vertex < 0) {
                vertex = static_cast<std::int32_t>(surface.parts.size());
                surface.parts.push_back(boundary.elements[t]);
                mesh::Barycentric& weights = surface.weights.emplace_back();
                weights[static_cast<std::size_t>(std::ranges::find(nodes, corner) - nodes.begin())] = 1;
                surface.nodes.push_back(nodes);
            }
            corner = vertex;
        }
        surface.triangles.push_back(triangle);
    }
    surface.is_wall.assign(surface.triangles.size(), 0);
    surface.corners = {surface.parts.size(), surface.triangles};
    return surface;
}

CarriedSurface boundary_surface(const mesh::CutMesh& cut) {
    mesh::PartGeometry geometry = mesh::part_geometry(cut);
    CarriedSurface surface;
    surface.is_wall = std::move(geometry.is_wall);
    std::vector<std::int32_t> vertex_of_point(geometry.points.size(), -1);
    for (mesh::Triangle triangle : geometry.triangles) {
        for (std::int32_t& corner : triangle) {
            std::int32_t& vertex = vertex_of_point[static_cast<std::size_t>(corner)];
            if (vertex < 0) {
                const auto& [part, weights] = geometry.points[static_cast<std::size_t>(corner)];
                vertex = static_cast<std::int32_t>(surface.parts.size());
                surface.parts.push_back(part);
                surface.weights.push_back(weights);
                surface.nodes.push_back(cut.parts()[static_cast<std::size_t>(part)]);
            }
            corner = vertex;
        }
        surface.triangles.push_back(triangle);
    }
    surface.corners = {surface.parts.size(), surface.triangles};
    return surface;
}

void place(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes, std::vector<Point>& out) {
    out.resize(surface.parts.size());
    for_each_block_of_vertices(scheduler, out.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            Point at{};
            for (std::size_t k = 0; k < 4; ++k) {
                const Point& node = nodes[static_cast<std::size_t>(surface.nodes[vertex][k])];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    at[axis] += surface.weights[vertex][k] * node[axis];
                }
            }
            out[vertex] = at;
        }
    });
}

void evaluate(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes, SurfaceShape& out) {
    place(scheduler, surface, nodes, out.positions);
    out.normals.resize(out.positions.size());
    for_each_block_of_vertices(scheduler, out.normals.size(), [&](std::size_t begin, std::size_t end) {
        mesh::vertex_normals(surface.corners, out.positions, begin, end, out.normals);
    });
}

}  // namespace lancet::runtime
