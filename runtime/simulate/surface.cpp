#include "lancet/runtime/simulate/surface.hpp"

#include <algorithm>

#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/surface/corner_normals.hpp"

namespace lancet::runtime {

namespace {

/// Some tens of microseconds of work, whatever the number of threads.
constexpr std::size_t per_block = 1024;

template <class Body>
void for_each_range(Scheduler& scheduler, std::size_t size, const Body& body) {
    scheduler.for_each_block(static_cast<int>((size + per_block - 1) / per_block), [&](int block) {
        const std::size_t begin = static_cast<std::size_t>(block) * per_block;
        body(begin, std::min(size, begin + per_block));
    });
}

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
    surface.corners = {surface.vertices.size(), surface.triangles};
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
    surface.corners = {surface.vertices.size(), surface.triangles};
    return surface;
}

CarriedSurface carried_surface(const mesh::EmbeddedSurface& fine) {
    CarriedSurface surface;
    for (std::size_t vertex = 0; vertex < fine.points().size(); ++vertex) {
        surface.vertices.add(fine.points()[vertex], fine.copies()[vertex]);
    }
    surface.triangles.assign(fine.triangles().begin(), fine.triangles().end());
    surface.is_wall.assign(fine.is_wall().begin(), fine.is_wall().end());
    surface.corners = {surface.vertices.size(), surface.triangles};
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

void SurfaceEvaluator::evaluate(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes,
                                SurfaceShape& out) {
    surface.vertices.place(scheduler, nodes, out.positions);
    corner_normals_.resize(3 * surface.triangles.size());
    for_each_range(scheduler, surface.triangles.size(), [&](std::size_t begin, std::size_t end) {
        mesh::corner_normals(std::span(surface.triangles).subspan(begin, end - begin), out.positions,
                             std::span(corner_normals_).subspan(3 * begin, 3 * (end - begin)));
    });
    out.normals.resize(out.positions.size());
    for_each_range(scheduler, out.normals.size(), [&](std::size_t begin, std::size_t end) {
        mesh::add_corner_normals(surface.corners, corner_normals_, begin, end, out.normals);
    });
}

}  // namespace lancet::runtime
