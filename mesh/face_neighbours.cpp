#include "lancet/mesh/face_neighbours.hpp"

#include <algorithm>
#include <utility>

namespace lancet::mesh {

std::vector<std::array<std::int32_t, 4>> face_neighbours(const TetMesh& mesh) {
    struct Face {
        Triangle nodes;
        std::int32_t element;
        int corner;
    };
    std::vector<Face> faces;
    faces.reserve(4 * mesh.tetrahedra().size());
    for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) {
        const Tetrahedron& t = mesh.tetrahedra()[e];
        for (int corner = 0; corner < 4; ++corner) {
            Triangle nodes{t[(corner + 1) % 4], t[(corner + 2) % 4], t[(corner + 3) % 4]};
            std::sort(nodes.begin(), nodes.end());
            faces.push_back({nodes, static_cast<std::int32_t>(e), corner});
        }
    }
    std::sort(faces.begin(), faces.end(),
              [](const Face& a, const Face& b) { return std::tie(a.nodes, a.element) < std::tie(b.nodes, b.element); });
    std::vector<std::array<std::int32_t, 4>> neighbours(mesh.tetrahedra().size(), {-1, -1, -1, -1});
    for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
        while (end < faces.size() && faces[end].nodes == faces[begin].nodes) ++end;
        if (end - begin != 2) continue;
        const Face &a = faces[begin], &b = faces[begin + 1];
        neighbours[static_cast<std::size_t>(a.element)][static_cast<std::size_t>(a.corner)] = b.element;
        neighbours[static_cast<std::size_t>(b.element)][static_cast<std::size_t>(b.corner)] = a.element;
    }
    return neighbours;
}

NodeStars node_stars(const TetMesh& mesh) {
    NodeStars stars;
    stars.first.assign(mesh.nodes().size() + 1, 0);
    for (const Tetrahedron& t : mesh.tetrahedra()) {
        for (const std::int32_t node : t) ++stars.first[static_cast<std::size_t>(node) + 1];
    }
    for (std::size_t n = 0; n < mesh.nodes().size(); ++n) stars.first[n + 1] += stars.first[n];
    stars.elements.resize(stars.first.back());
    std::vector<std::size_t> next(stars.first.begin(), stars.first.end() - 1);
    for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) {
        for (const std::int32_t node : mesh.tetrahedra()[e]) {
            stars.elements[next[static_cast<std::size_t>(node)]++] = static_cast<std::int32_t>(e);
        }
    }
    return stars;
}

}  // namespace lancet::mesh
