#include "lancet/runtime/integrate/floor_contact.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::runtime {

FloorContact::FloorContact(const Floor& floor, const kernels::NodeNumbering& numbering,
                           std::span<const double> position, double epsilon)
    : floor_(floor), touches_(static_cast<std::size_t>(numbering.node_count), 0) {
    const double length = std::hypot(floor.normal[0], floor.normal[1], floor.normal[2]);
    if (!(std::abs(length - 1) < 1e-6)) {
        throw Error("scene: the floor's normal has length " + std::to_string(length) + "; expected 1");
    }
    double size = 0;
    for (const double value : floor.point) {
        if (!std::isfinite(value)) throw Error("scene: the floor's point is not finite");
        size = std::max(size, std::abs(value));
    }
    for (const double value : position) size = std::max(size, std::abs(value));
    rounding_ = std::max(16 * epsilon, 1e-12) * size;
    contacts_.reserve(static_cast<std::size_t>(numbering.free_count));
}

double FloorContact::height(std::span<const double> position, std::size_t node) const noexcept {
    double height = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        height += floor_->normal[axis] * (position[4 * node + axis] - floor_->point[axis]);
    }
    return height;
}

double FloorContact::along_normal(std::span<const double> vector, std::size_t node) const noexcept {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) sum += floor_->normal[axis] * vector[4 * node + axis];
    return sum;
}

void FloorContact::require_above(const kernels::NodeNumbering& numbering, std::span<const double> position) const {
    if (!floor_) return;
    for (std::size_t user = 0; user < numbering.internal_of_user.size(); ++user) {
        const std::int32_t node = numbering.internal_of_user[user];
        if (!numbering.is_free(node)) continue;
        const double above = height(position, static_cast<std::size_t>(node));
        if (above >= -rounding_) continue;
        throw Error("node " + std::to_string(user) + " lies " + std::to_string(-above) +
                    " m below the floor; expected every free node above it");
    }
}

bool FloorContact::is_touched(const kernels::NodeNumbering& numbering) const noexcept {
    return std::ranges::any_of(contacts_,
                               [&](const Holds::Contact& contact) { return !numbering.sleeping.has(contact.node); });
}

bool FloorContact::let_go(const kernels::NodeNumbering& numbering, std::span<const double> velocity,
                          std::span<const double> force, double h) {
    return std::erase_if(contacts_, [&](const Holds::Contact& contact) {
               const auto node = static_cast<std::size_t>(contact.node);
               if (numbering.sleeping.has(contact.node)) return false;
               if (along_normal(force, node) < 0 && h * along_normal(velocity, node) <= rounding_) return false;
               touches_[node] = 0;
               return true;
           }) > 0;
}

bool FloorContact::add(const kernels::NodeNumbering& numbering, std::span<const double> start,
                       std::span<const double> end) {
    const std::size_t before = contacts_.size();
    for (std::int32_t internal = 0; internal < numbering.free_count; ++internal) {
        const auto node = static_cast<std::size_t>(internal);
        if (touches_[node] != 0 || numbering.user_of_internal[node] < 0 || numbering.sleeping.has(internal)) continue;
        const double above = height(start, node);
        const double lowest = above > -2 * rounding_ ? -rounding_ : above;
        if (!(height(end, node) < lowest)) continue;
        const double down = above > -2 * rounding_ ? above : 0.0;
        mesh::Point place;
        for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = start[4 * node + axis] - down * floor_->normal[axis];
        contacts_.push_back({internal, place});
        touches_[node] = 1;
    }
    return contacts_.size() > before;
}

void FloorContact::forget(std::int32_t node) {
    std::erase_if(contacts_, [&](const Holds::Contact& contact) { return contact.node == node; });
    touches_[static_cast<std::size_t>(node)] = 0;
}

void FloorContact::restore(std::span<const Holds::Contact> contacts) {
    for (const Holds::Contact& contact : contacts_) touches_[contact.node] = 0;
    contacts_.assign(contacts.begin(), contacts.end());
    for (const Holds::Contact& contact : contacts_) touches_[contact.node] = 1;
}

std::size_t FloorContact::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(contacts_) + heap_bytes(touches_);
}

}  // namespace lancet::runtime
