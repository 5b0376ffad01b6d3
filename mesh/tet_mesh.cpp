#include "lancet/mesh/tet_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/inspect.hpp"

namespace lancet::mesh {

std::array<double, 4> barycentric(const std::array<Point, 4>& corners, const Point& place) {
    const double volume = signed_volume(corners[0], corners[1], corners[2], corners[3]);
    std::array<double, 4> weights{};
    for (std::size_t k = 0; k < 4; ++k) {
        std::array<Point, 4> replaced = corners;
        replaced[k] = place;
        weights[k] = signed_volume(replaced[0], replaced[1], replaced[2], replaced[3]) / volume;
    }
    return weights;
}

double area(const Point& a, const Point& b, const Point& c) {
    const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    return std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
}

double signed_volume(const Point& a, const Point& b, const Point& c, const Point& d) {
    const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const Point v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const Point w{d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
            u[2] * (v[0] * w[1] - v[1] * w[0])) /
           6.0;
}

TetMesh::TetMesh(Definition definition) : definition_(std::move(definition)) {
    if (definition_.regions.empty()) definition_.regions.assign(definition_.tetrahedra.size(), 0);
    for (auto& [name, nodes] : definition_.node_sets) {
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }
    const Inspection inspection = inspect(definition_);
    if (!inspection.clean()) throw Error("mesh: " + describe(inspection, definition_));
}

std::span<const std::int32_t> TetMesh::node_set(const std::string& name) const {
    const auto found = definition_.node_sets.find(name);
    if (found != definition_.node_sets.end()) return found->second;
    std::string known;
    for (const auto& [other, nodes] : definition_.node_sets) known += (known.empty() ? "" : ", ") + other;
    throw Error("mesh: no node set '" + name + "'; there are: " + (known.empty() ? "none" : known));
}

double TetMesh::volume(std::int32_t tetrahedron) const {
    const auto& t = definition_.tetrahedra.at(static_cast<std::size_t>(tetrahedron));
    const auto& x = definition_.nodes;
    return signed_volume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]);
}

double TetMesh::volume() const {
    double sum = 0;
    for (std::size_t t = 0; t < definition_.tetrahedra.size(); ++t) sum += volume(static_cast<std::int32_t>(t));
    return sum;
}

std::array<Point, 2> TetMesh::bounds() const {
    if (definition_.nodes.empty()) return {};
    std::array<Point, 2> box{definition_.nodes.front(), definition_.nodes.front()};
    for (const Point& x : definition_.nodes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box[0][axis] = std::min(box[0][axis], x[axis]);
            box[1][axis] = std::max(box[1][axis], x[axis]);
        }
    }
    return box;
}

}  // namespace lancet::mesh
