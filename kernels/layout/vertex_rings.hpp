#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/kernels/surface/normal_kernels.hpp"

namespace lancet::kernels {

using Triangle = std::array<std::int32_t, 3>;

/// The neighbours of each vertex of a surface of triangles in the order in which its triangles go around it, laid out
/// for kernels that work on a vertex in every lane. Neighbours that follow each other, and the vertex, are a triangle.
/// Where the triangles do not hang together the vertex itself stands between them: two triangles without an area.
///
/// Batches do not depend on the instruction set, and hold vertices with about as many neighbours each: those of a block
/// of 1024 are sorted by that. The last batch of a block repeats its last vertex.
struct VertexRings {
    static constexpr int lanes = ring_lanes;      ///< of a batch
    static constexpr int batches_per_block = 64;  ///< work unit of a scheduler

    std::vector<std::int32_t> slot_begin{0};  ///< [batch] its first slot, and the end
    // Vertices are named by the places of their rows among rows of three, 3 times their numbers.
    AlignedVector<std::int32_t> vertices{};    ///< [batch][lane]
    AlignedVector<std::int32_t> neighbours{};  ///< [slot][lane]

    int batches() const noexcept { return static_cast<int>(slot_begin.size()) - 1; }
    int blocks() const noexcept { return (batches() + batches_per_block - 1) / batches_per_block; }
    std::size_t bytes() const noexcept;
};

/// Lays the vertices [0, vertices) out. Triangles are numbers of vertices, and those with a repeated one are left out.
/// Time is linear where vertices have few neighbours, n log n in those of one.
VertexRings vertex_rings(std::size_t vertices, std::span<const Triangle> triangles);

}  // namespace lancet::kernels
