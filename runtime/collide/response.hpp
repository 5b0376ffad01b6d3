#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/runtime/collide/tool_contact.hpp"
#include "lancet/runtime/collide/vertex_contact.hpp"

namespace lancet::runtime {

/// A spring and a damper in each contact: the force along the normal is
///     max(0, stiffness depth + damping d(depth)/dt),
/// for a tool times the contact's share. Contacts push, they never pull.
struct Penalty {
    double stiffness = 1000;  ///< N / m
    double damping = 0;       ///< N s / m
};

/// Throws lancet::Error for a negative stiffness or damping, or one that is not finite.
void validate(const Penalty& penalty);

/// How a tool moves: v(x) = linear + angular x (x - about).
struct RigidVelocity {
    Point linear{};   ///< m / s
    Point angular{};  ///< rad / s
    Point about{};
};

/// A force in newtons and its moment in newton metres.
struct Wrench {
    Point force{};
    Point moment{};
};

/// Adds the forces of a tool to those on the nodes, by the weights of the corners, and returns what they do to the
/// tool, the moment about `tool.about`: together they vanish. `velocities` of the nodes may be empty where there is no
/// damping.
Wrench add_penalty_forces(std::span<const ToolContact> contacts, const Penalty& penalty,
                          std::span<const mesh::Triangle> triangles, std::span<const Point> velocities,
                          const RigidVelocity& tool, std::span<Point> forces);

/// Adds the forces of vertices in tetrahedra: on the vertex along the normal, against it on the corners by their
/// weights. As a vertex lies at the weighted mean of the corners, force and moment of all vanish. For self-collision
/// both bodies are one. Velocities may be empty where there is no damping.
void add_penalty_forces(std::span<const VertexContact> contacts, const Penalty& penalty,
                        std::span<const mesh::Tetrahedron> second_tetrahedra, std::span<const Point> first_velocities,
                        std::span<const Point> second_velocities, std::span<Point> first_forces,
                        std::span<Point> second_forces);

/// The energy in the springs: sum of share stiffness depth^2 / 2, in joules.
double penalty_energy(std::span<const ToolContact> contacts, const Penalty& penalty) noexcept;
double penalty_energy(std::span<const VertexContact> contacts, const Penalty& penalty) noexcept;

/// Where a node has to be led so that a contact ends; see DeformableBody::hold.
struct ContactHold {
    std::int32_t node = 0;
    Point target{};
    Point direction{};  ///< of unit length
};

/// Replaces `holds` by those that lead the surface out of a tool, by node. Each contact is ended by the smallest
/// displacement (in the sum of squares over the corners, which go by -depth w_i / sum w^2 along the normal). A node of
/// several contacts gets the one that moves it farthest: what is left ends in later steps. Prescribed motion has the
/// tool's momentum, not the body's.
void tool_holds(std::span<const ToolContact> contacts, std::span<const mesh::Triangle> triangles,
                std::span<const Point> positions, std::vector<ContactHold>& holds);

/// The same for vertices in tetrahedra: with s = depth / (1 + sum w^2) the vertex goes by s, the corners by -s w_i.
/// For self-collision the holds of both are to be merged by the caller, or one of them left out.
void vertex_holds(std::span<const VertexContact> contacts, std::span<const mesh::Tetrahedron> second_tetrahedra,
                  std::span<const Point> first_positions, std::span<const Point> second_positions,
                  std::vector<ContactHold>& first_holds, std::vector<ContactHold>& second_holds);

}  // namespace lancet::runtime
