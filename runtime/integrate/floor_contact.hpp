#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/holds.hpp"

namespace lancet::runtime {

/// Which nodes rest on a rigid, frictionless half-space. A node comes into contact before a step whose prediction
/// x + h v + h^2 gravity lies below the surface: for that step it is held in the direction of the normal, on the
/// surface, or where it is if it lies below already, since lifting it would add energy. It is let go before a step at
/// whose start the forces on it pull it off, or when it moves off.
///
/// So the normal velocity that a contact takes away is lost (no bounce), and a node that others push below the surface
/// in a step whose prediction did not is there to stay until it is pulled up: by less than h times what its velocity
/// changed in that step.
class FloorContact {
  public:
    /// No floor.
    FloorContact() = default;
    /// `position` at rest, xyz_ in the internal numbering. Throws lancet::Error for a normal that is not of unit
    /// length.
    FloorContact(const Floor& floor, const kernels::NodeNumbering& numbering, std::span<const double> position);

    bool exists() const noexcept { return floor_.has_value(); }
    bool is_touched() const noexcept { return !contacts_.empty(); }
    /// Throws lancet::Error if a node lies below the floor by more than rounding; names it in the user's numbering.
    void require_above(const kernels::NodeNumbering& numbering, std::span<const double> position) const;

    /// Finds the contacts of a step of h seconds. `force`: on each node without the floor's, xyz_ in newtons, read
    /// where there is contact. True if they are not of the same nodes as before.
    bool update(const kernels::NodeNumbering& numbering, std::span<const double> position,
                std::span<const double> velocity, std::span<const double> force, const std::array<double, 3>& gravity,
                double h);

    std::span<const Holds::Contact> contacts() const noexcept { return contacts_; }
    const mesh::Point& normal() const noexcept { return floor_->normal; }

    /// Takes up saved contacts.
    void restore(std::span<const Holds::Contact> contacts);
    std::size_t bytes() const noexcept;

  private:
    double height(std::span<const double> position, std::size_t node) const noexcept;
    double along_normal(std::span<const double> vector, std::size_t node) const noexcept;

    std::optional<Floor> floor_;
    double rounding_ = 0;  ///< metres
    std::vector<Holds::Contact> contacts_, next_;
    std::vector<std::uint8_t> touches_;  ///< [node]
};

}  // namespace lancet::runtime
