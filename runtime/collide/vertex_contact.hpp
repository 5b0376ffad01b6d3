#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lancet/runtime/collide/collidable_body.hpp"

namespace lancet::runtime {

/// A node of one body in a tetrahedron of another, or of the same.
struct VertexContact {
    std::int32_t vertex = 0;          ///< of the first body
    std::int32_t tetrahedron = 0;     ///< of the second: the first that contains the vertex
    std::array<double, 4> weights{};  ///< of its corners, not negative but for rounding
    double depth = 0;                 ///< positive: how far along the normal the vertex has to go to get out
    Point normal{};                   ///< unit vector out of the second body
};

/// Finds vertices in tetrahedra (Teschner et al. 2003, Optimized Spatial Hashing for Collision Detection of Deformable
/// Objects), and how deep they are (Heidelberger et al. 2004, Consistent Penetration Depth Estimation for Deformable
/// Collision Response):
///   1. A vertex collides if a tetrahedron of the other body contains it, unless it lies on the surface; of its own
///      body, one that it is no corner of, without its faces.
///   2. Where an edge between a colliding vertex p and one that does not collide passes into the other body's surface,
///      at x with normal n: with w = 1 / |x - p|^2 and sums over the edges of p,
///          depth = sum w (x - p) . n / sum w,  normal along sum w n.
///   3. From there inwards, level by level along edges: with w = 1 / |q - p|^2 and sums over the neighbours q that are
///      known, depth = sum w ((q - p) . normal_q + depth_q) / sum w, normal along sum w normal_q.
/// So depth and normal are those of the surface that was entered, also deep inside, and change little between
/// neighbours and steps.
///
/// Not found: vertices exactly on the inner faces of their own body's tetrahedra, as in a body that is folded
/// symmetrically to the last bit; edges that pass through edges or faces with no vertex inside (bodies should be meshed
/// alike where they touch). Found, but without a depth: vertices of a group that no edge leads out of, such as those of
/// a body that is wholly inside of the other; and where the tetrahedron of step 1 is inverted or its body overlaps
/// itself, edges may find no surface. They are counted.
class VertexContactFinder {
  public:
    /// The vertices of `first` in `second`, by vertex; they replace what was in `contacts`. Both may be one object:
    /// then for self-collision.
    void find(Scheduler& scheduler, const CollidableBody& first, const CollidableBody& second,
              std::vector<VertexContact>& contacts);

    /// Of the last call: pairs of a vertex and a box of a tetrahedron around it.
    std::size_t candidates() const noexcept { return pairs_.size(); }
    /// Of the last call: vertices that collide and have no depth.
    std::size_t unresolved() const noexcept { return unresolved_; }

  private:
    void find_vertices(Scheduler& scheduler, const CollidableBody& first, const CollidableBody& second,
                       std::vector<VertexContact>& contacts);
    void enter_surface(const CollidableBody& first, const CollidableBody& second, std::vector<VertexContact>& contacts);
    void propagate(const CollidableBody& first, std::vector<VertexContact>& contacts);

    struct Sums {
        double weight = 0, depth = 0;
        Point normal{};
    };
    std::vector<BoxPair> pairs_;
    std::vector<std::int32_t> contact_of_;  ///< [vertex] or -1
    std::vector<Sums> sums_;                ///< [contact]
    std::vector<int> level_;                ///< [contact] step at which its depth was found, or -1
    std::vector<std::int32_t> triangles_;
    std::size_t unresolved_ = 0;
};

}  // namespace lancet::runtime
