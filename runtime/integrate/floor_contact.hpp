#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/holds.hpp"

namespace lancet::runtime {

/// Which nodes rest on a rigid, frictionless half-space. A step is taken with the contacts known; nodes that it brings
/// below the surface are added to them, and it is taken anew, until there are none. A contact holds the node in the
/// direction of the normal so that it ends the step on the surface, or stays where it was if that is below: lifting it
/// would add energy. A contact ends before a step at whose start the forces on the node pull it off.
///
/// So no node passes the surface, what a contact stops is lost (no bounce), and the floor does no work on nodes that
/// would have passed it but what it takes.
class FloorContact {
  public:
    /// No floor.
    FloorContact() = default;
    /// `position` at rest, xyz_ in the internal numbering; `epsilon` of the scalar in which steps are solved: heights
    /// are known to some multiple of it. Throws lancet::Error for a normal that is not of unit
    /// length.
    FloorContact(const Floor& floor, const kernels::NodeNumbering& numbering, std::span<const double> position,
                 double epsilon);

    bool exists() const noexcept { return floor_.has_value(); }
    /// Whether a node that is awake rests on it.
    bool is_touched(const kernels::NodeNumbering& numbering) const noexcept;
    /// Throws lancet::Error if a node lies below the floor by more than rounding; names it in the user's numbering.
    void require_above(const kernels::NodeNumbering& numbering, std::span<const double> position) const;

    /// Ends the contacts that pull, but for those of nodes that are asleep, before a step of h seconds. `force`: on
    /// each node without the floor's, xyz_ in newtons, read at the nodes in contact. True if there were any.
    bool let_go(const kernels::NodeNumbering& numbering, std::span<const double> velocity,
                std::span<const double> force, double h);
    /// Adds the nodes that a step has brought from `start` to `end` below the surface. True if there are any.
    bool add(const kernels::NodeNumbering& numbering, std::span<const double> start, std::span<const double> end);

    std::span<const Holds::Contact> contacts() const noexcept { return contacts_; }
    const mesh::Point& normal() const noexcept { return floor_->normal; }

    /// Ends the contact of a node that is no more.
    void forget(std::int32_t node);
    /// Takes up saved contacts.
    void restore(std::span<const Holds::Contact> contacts);
    std::size_t bytes() const noexcept;

  private:
    double height(std::span<const double> position, std::size_t node) const noexcept;
    double along_normal(std::span<const double> vector, std::size_t node) const noexcept;

    std::optional<Floor> floor_;
    double rounding_ = 0;  ///< metres
    std::vector<Holds::Contact> contacts_;
    std::vector<std::uint8_t> touches_;  ///< [node]
};

}  // namespace lancet::runtime
