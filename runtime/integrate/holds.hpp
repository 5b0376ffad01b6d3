#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/solve/constraints.hpp"

namespace lancet::runtime {

/// A node that is led to a target along up to three orthonormal directions; across them it is free.
struct HeldNode {
    std::int32_t node = 0;  ///< internal numbering
    int count = 0;
    std::array<mesh::Point, 3> directions{};
    mesh::Point target{};

    /// Adds a direction of unit length along which the node is to come where `place` is. Directions that are there
    /// already go before; of the new one the part across them is taken.
    void add(const mesh::Point& direction, const mesh::Point& place) noexcept;
    /// Adds all three directions.
    void add_all(const mesh::Point& place) noexcept;
};

/// All that leads free nodes of a body for a while: the scene's prescribed displacements, the user's holds, and
/// contacts with the floor, in this order of precedence where they meet in one node.
class Holds {
  public:
    Holds() = default;
    /// Takes up the prescribed displacements of a scene that validate_constraints has accepted. Throws lancet::Error
    /// for those of fixed nodes.
    Holds(const Scene& scene, const kernels::NodeNumbering& numbering);

    /// Leads a node (internal numbering) to a target, in all directions or, with a unit `direction` other than zero,
    /// along it; replaces the earlier hold of the node. True if other directions are held than before.
    bool hold(std::int32_t node, const mesh::Point& target, const mesh::Point& direction);
    void release(std::int32_t node);
    void release_all();

    /// Adds a prescribed displacement of a free node (internal numbering), which is at `rest` on that axis.
    void prescribe(const PrescribedDisplacement& prescribed, std::int32_t node, double rest);
    /// Takes away what leads a node that is no more.
    void forget(std::int32_t node);

    /// A node that rests on a plane with the given normal.
    struct Contact {
        std::int32_t node;  ///< internal numbering
        mesh::Point place;
    };
    std::span<const Contact> contacts() const noexcept { return contacts_; }
    /// Replaces the contacts. `changed`: they are not of the same nodes as before.
    void set_contacts(std::span<const Contact> contacts, const mesh::Point& normal, bool changed);

    /// Tells that other nodes are asleep than before (NodeNumbering::sleeping). Nothing leads them, and the filter
    /// keeps them where they are.
    void change_sleepers() noexcept { filter_is_known_ = false; }

    /// Takes the targets of a step that ends at `time` seconds. Throws lancet::Error for prescribed displacements that
    /// are not finite. Allocates only where other nodes are held than before.
    void prepare(const kernels::NodeNumbering& numbering, double time);

    bool empty() const noexcept { return active_.empty(); }
    const ConstraintFilter& filter() const noexcept { return filter_; }
    /// Gives held nodes the velocity that brings them to their targets in one step of h seconds, in the held
    /// directions.
    void apply(std::span<const double> position, std::span<double> velocity, double h) const noexcept;

    /// Holds and contacts as numbers; what the scene prescribes is not among them.
    std::vector<double> save() const;
    void restore(std::span<const double> numbers);
    std::size_t bytes() const noexcept;

  private:
    struct Prescribed {
        std::int32_t node;
        std::int32_t user_node;
        std::size_t axis;
        double rest;  ///< metres
        std::function<double(double)> displacement;
    };
    struct Hold {
        std::int32_t node;
        mesh::Point target;
        mesh::Point direction;  ///< zero: all three
    };
    HeldNode& active(std::int32_t node);

    std::vector<Prescribed> prescribed_;
    std::vector<Hold> holds_;
    std::vector<Contact> contacts_;
    mesh::Point normal_{};
    std::vector<HeldNode> active_;
    std::vector<std::int32_t> place_of_node_;  ///< in active_, or -1
    ConstraintFilter filter_;
    bool filter_is_known_ = true;
};

}  // namespace lancet::runtime
