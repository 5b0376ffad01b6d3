#include "lancet/mesh/embed/surface_facets.hpp"

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

namespace {

/// A number in [-1, 1] that looks random and depends on its arguments alone (Steele et al. 2014, splitmix64).
double scattered(std::uint64_t number) {
    number += 0x9e3779b97f4a7c15;
    number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9;
    number = (number ^ (number >> 27)) * 0x94d049bb133111eb;
    number ^= number >> 31;
    return static_cast<double>(number >> 11) * 0x1p-52 - 1;
}

}  // namespace

SurfaceFacets::SurfaceFacets(TriangleMesh surface) : surface_(std::move(surface)) {
    require_valid("embedded surface", surface_.vertices, surface_.triangles);
    std::erase_if(surface_.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    const SurfaceTopology topology = surface_topology(surface_.vertices.size(), surface_.triangles);
    if (topology.overused_edges > 0) {
        throw Error("embedded surface: " + std::to_string(topology.overused_edges) +
                    " edges have more than two triangles; expected one or two");
    }
    is_closed_ = topology.is_closed() && topology.is_boundary() && !surface_.triangles.empty();
    const auto box = bounds(surface_.vertices);
    const double reach = 0x1p-36 * std::hypot(box[1][0] - box[0][0], box[1][1] - box[0][1], box[1][2] - box[0][2]);
    moved_ = surface_;
    facets_.resize(surface_.triangles.size());
    for (std::size_t v = 0; v < moved_.vertices.size(); ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) moved_.vertices[v][axis] += reach * scattered(3 * v + axis);
    }
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> numbers;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        const Triangle& corners = surface_.triangles[t];
        std::array<std::int32_t, 3>& edges = edges_of_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [place, is_new] = numbers.try_emplace(std::minmax(corners[k], corners[(k + 1) % 3]),
                                                             static_cast<std::int32_t>(triangles_of_.size()));
            edges[k] = place->second;
            if (is_new) triangles_of_.push_back({-1, -1});
            triangles_of_[static_cast<std::size_t>(edges[k])][is_new ? 0 : 1] = static_cast<std::int32_t>(t);
        }
    }
}

const CutSurface& SurfaceFacets::facet(std::int32_t triangle) {
    std::optional<CutSurface>& facet = facets_[static_cast<std::size_t>(triangle)];
    if (facet) return *facet;
    std::array<Point, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = moved_.vertices[static_cast<std::size_t>(moved_.triangles[static_cast<std::size_t>(triangle)][k])];
    }
    constexpr std::array<Triangle, 1> triangles{{{0, 1, 2}}};
    return facet.emplace(CutSurface::triangulated(corners, triangles));
}

}  // namespace lancet::mesh
