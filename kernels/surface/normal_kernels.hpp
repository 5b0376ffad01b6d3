#pragma once

#include <cstdint>

namespace lancet::kernels {

/// Vertices in a batch of VertexRings, whatever the instruction set: a multiple of every width.
inline constexpr int ring_lanes = 16;

/// The normals of the vertices of a surface that has been laid out as VertexRings.
struct VertexNormalArguments {
    const std::int32_t* slot_begin;  ///< this and the next two as VertexRings
    const std::int32_t* vertices;
    const std::int32_t* neighbours;
    const double* positions;  ///< [vertex][3]
    double* normals;          ///< [vertex][3], of unit length
    /// [batch] a bit for each lane whose normal this arithmetic cannot find: it has been set to zero.
    std::uint16_t* doubtful;
};

/// Kernels of surfaces. They are in float whatever the scalar of a kernel set: normals are there to be looked at.
struct NormalKernels {
    /// The unit vector along the sum of the normals of the triangles around a vertex, weighted by their angles there,
    /// for the vertices of the batches [begin, end). Edges are differences in double that are then rounded to float.
    ///
    /// With u = 2^-24 and the angles a_k at the vertex, the sum is in error by at most sum_k e_k, where e_k is
    /// (8 + 40 a_k) u for an angle of up to 104 degrees and 64 u a_k / sin a_k for a larger one, and the unit vector by
    /// that over the length of the sum and 4 u. Between six triangles in a plane that is 3e-6; what has been seen is a
    /// tenth of it.
    ///
    /// Triangles without an area and edges of less than 1e-18 m or more than 1e18 m count for nothing. Doubtful are
    /// vertices with a neighbour that is not finite, with an angle of more than 178.8 degrees, where the direction of a
    /// normal is lost in rounding, and those at which less than an eighth of a radian is left of the sum. No lane
    /// depends on another.
    void (*vertex_normals)(const VertexNormalArguments& arguments, int begin, int end);
};

}  // namespace lancet::kernels
