#include "lancet/mesh/boundary.hpp"

#include <algorithm>
#include <array>

namespace lancet::mesh {

namespace {

struct Face {
    std::int32_t middle, high;
    std::int64_t place;  // 4 * element + face
};

Triangle face_nodes(const TetMesh& mesh, std::int64_t place) {
    const Tetrahedron& t = mesh.tetrahedra()[static_cast<std::size_t>(place / 4)];
    const Triangle& face = opposite_faces[static_cast<std::size_t>(place % 4)];
    return {t[face[0]], t[face[1]], t[face[2]]};
}

}  // namespace

Boundary boundary(const TetMesh& mesh) {
    // Faces grouped by their lowest node with a counting sort; equal ones meet in a small group.
    const std::int64_t face_count = 4 * static_cast<std::int64_t>(mesh.tetrahedra().size());
    std::vector<std::size_t> first(mesh.nodes().size() + 1, 0);
    for (std::int64_t place = 0; place < face_count; ++place) {
        const Triangle nodes = face_nodes(mesh, place);
        ++first[static_cast<std::size_t>(std::min({nodes[0], nodes[1], nodes[2]})) + 1];
    }
    for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
    std::vector<Face> grouped(static_cast<std::size_t>(face_count));
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::int64_t place = 0; place < face_count; ++place) {
        Triangle nodes = face_nodes(mesh, place);
        std::sort(nodes.begin(), nodes.end());
        grouped[next[nodes[0]]++] = {nodes[1], nodes[2], place};
    }

    Boundary result;
    std::vector<std::int64_t> outside;
    for (std::size_t n = 0; n + 1 < first.size(); ++n) {
        const auto begin = grouped.begin() + static_cast<std::ptrdiff_t>(first[n]);
        const auto end = grouped.begin() + static_cast<std::ptrdiff_t>(first[n + 1]);
        std::sort(begin, end, [](const Face& left, const Face& right) {
            return left.middle != right.middle ? left.middle < right.middle : left.high < right.high;
        });
        for (auto run = begin; run != end;) {
            auto after = run + 1;
            while (after != end && after->middle == run->middle && after->high == run->high) ++after;
            if (after - run == 1) outside.push_back(run->place);
            if (after - run > 2) ++result.overused_faces;
            run = after;
        }
    }
    std::sort(outside.begin(), outside.end());
    result.triangles.reserve(outside.size());
    result.elements.reserve(outside.size());
    for (const std::int64_t place : outside) {
        result.triangles.push_back(face_nodes(mesh, place));
        result.elements.push_back(static_cast<std::int32_t>(place / 4));
    }
    return result;
}

}  // namespace lancet::mesh
