#include "lancet/runtime/simulate/surface.hpp"

#include <algorithm>
#include <bit>

#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"

namespace lancet::runtime {

namespace {

/// Numbers what triangles use of some points, in the order of its first use.
class Renumbering {
  public:
    explicit Renumbering(std::size_t points) : number_(points, -1) {}

    /// The new number; calls add() where it is the first time.
    template <class Add>
    std::int32_t of(std::int32_t point, const Add& add) {
        std::int32_t& number = number_[static_cast<std::size_t>(point)];
        if (number < 0) {
            number = count_++;
            add();
        }
        return number;
    }

  private:
    std::vector<std::int32_t> number_;
    std::int32_t count_ = 0;
};

/// The corner of an element as a point of its material.
mesh::MaterialPoint corner_of(const mesh::Tetrahedron& nodes, std::int32_t element, std::int32_t node) {
    mesh::MaterialPoint point{.part = element};
    point.weights[static_cast<std::size_t>(std::ranges::find(nodes, node) - nodes.begin())] = 1;
    return point;
}

/// Of unit length in double, what is so in float; zero stays zero. One step of Newton's method for 1 / |n| from 1: an
/// error e of the length becomes 3 e^2 / 2.
void make_unit(Point& normal) {
    const double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    for (double& component : normal) component *= 1.5 - 0.5 * square;
}

void find_neighbours(CarriedSurface& surface) {
    surface.corners = {surface.vertices.size(), surface.triangles};
    surface.rings = kernels::vertex_rings(surface.vertices.size(), surface.triangles);
}

}  // namespace

CarriedSurface boundary_surface(const mesh::TetMesh& mesh) {
    CarriedSurface surface;
    Renumbering vertices(mesh.nodes().size());
    const mesh::Boundary boundary = mesh::boundary(mesh);
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
        const std::int32_t element = boundary.elements[t];
        const mesh::Tetrahedron& nodes = mesh.tetrahedra()[static_cast<std::size_t>(element)];
        mesh::Triangle triangle = boundary.triangles[t];
        for (std::int32_t& corner : triangle) {
            corner = vertices.of(corner, [&] { surface.vertices.add(corner_of(nodes, element, corner), nodes); });
        }
        surface.triangles.push_back(triangle);
    }
    surface.is_wall.assign(surface.triangles.size(), 0);
    find_neighbours(surface);
    return surface;
}

CarriedSurface boundary_surface(const mesh::CutMesh& cut, const mesh::PartGeometry& geometry) {
    CarriedSurface surface;
    surface.is_wall = geometry.is_wall;
    Renumbering vertices(geometry.points.size());
    for (mesh::Triangle triangle : geometry.triangles) {
        for (std::int32_t& corner : triangle) {
            corner = vertices.of(corner, [&] {
                const mesh::MaterialPoint& point = geometry.points[static_cast<std::size_t>(corner)];
                surface.vertices.add(point, cut.parts()[static_cast<std::size_t>(point.part)]);
            });
        }
        surface.triangles.push_back(triangle);
    }
    find_neighbours(surface);
    return surface;
}

CarriedSurface carried_surface(const mesh::EmbeddedSurface& fine) {
    CarriedSurface surface;
    for (std::size_t vertex = 0; vertex < fine.points().size(); ++vertex) {
        surface.vertices.add(fine.points()[vertex], fine.copies()[vertex]);
    }
    surface.triangles.assign(fine.triangles().begin(), fine.triangles().end());
    surface.is_wall.assign(fine.is_wall().begin(), fine.is_wall().end());
    find_neighbours(surface);
    return surface;
}

CarriedSolid carried_solid(const mesh::TetMesh& mesh) {
    CarriedSolid solid;
    std::vector<std::int32_t> element_of(mesh.nodes().size(), 0);
    for (std::size_t element = 0; element < mesh.tetrahedra().size(); ++element) {
        for (const std::int32_t node : mesh.tetrahedra()[element]) {
            element_of[static_cast<std::size_t>(node)] = static_cast<std::int32_t>(element);
        }
    }
    for (std::size_t node = 0; node < element_of.size(); ++node) {
        const mesh::Tetrahedron& nodes = mesh.tetrahedra()[static_cast<std::size_t>(element_of[node])];
        solid.points.add(corner_of(nodes, element_of[node], static_cast<std::int32_t>(node)), nodes);
    }
    solid.tetrahedra.assign(mesh.tetrahedra().begin(), mesh.tetrahedra().end());
    solid.triangles = mesh::boundary(mesh).triangles;
    return solid;
}

CarriedSolid carried_solid(const mesh::CutMesh& cut, const mesh::PartGeometry& geometry) {
    CarriedSolid solid;
    for (const mesh::MaterialPoint& point : geometry.points) {
        solid.points.add(point, cut.parts()[static_cast<std::size_t>(point.part)]);
    }
    solid.tetrahedra = geometry.tetrahedra;
    solid.triangles = geometry.triangles;
    return solid;
}

SurfaceEvaluator::SurfaceEvaluator(kernels::InstructionSet instruction_set)
    : kernels_(kernels::kernel_set<float>(instruction_set).normals) {}

void SurfaceEvaluator::find_normals(Scheduler& scheduler, const CarriedSurface& surface, SurfaceShape& shape) {
    shape.normals.resize(shape.positions.size());
    if (shape.positions.empty()) return;
    const kernels::VertexRings& rings = surface.rings;
    doubtful_.resize(static_cast<std::size_t>(rings.batches()));
    const kernels::VertexNormalArguments arguments{.slot_begin = rings.slot_begin.data(),
                                                   .vertices = rings.vertices.data(),
                                                   .neighbours = rings.neighbours.data(),
                                                   .positions = shape.positions.front().data(),
                                                   .normals = shape.normals.front().data(),
                                                   .doubtful = doubtful_.data()};
    scheduler.for_each_block(rings.blocks(), [&](int block) {
        const int begin = block * kernels::VertexRings::batches_per_block;
        const int end = std::min(rings.batches(), begin + kernels::VertexRings::batches_per_block);
        kernels_.vertex_normals(arguments, begin, end);
        for (int slot = begin * kernels::VertexRings::lanes; slot < end * kernels::VertexRings::lanes; ++slot) {
            make_unit(shape.normals[static_cast<std::size_t>(rings.vertices[static_cast<std::size_t>(slot)] / 3)]);
        }
        // What float cannot tell is found in double, vertex by vertex.
        for (int batch = begin; batch < end; ++batch) {
            for (unsigned lanes = doubtful_[static_cast<std::size_t>(batch)]; lanes != 0; lanes &= lanes - 1) {
                const int slot = batch * kernels::VertexRings::lanes + std::countr_zero(lanes);
                const auto vertex = static_cast<std::size_t>(rings.vertices[static_cast<std::size_t>(slot)] / 3);
                mesh::vertex_normals(surface.corners, shape.positions, vertex, vertex + 1, shape.normals);
            }
        }
    });
}

}  // namespace lancet::runtime
