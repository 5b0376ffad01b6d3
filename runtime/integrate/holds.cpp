#include "lancet/runtime/integrate/holds.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::runtime {

using mesh::Point;

namespace {

double dot(const Point& a, const Point& b) noexcept {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

constexpr std::array<Point, 3> axes{Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};

}  // namespace

void HeldNode::add(const Point& direction, const Point& place) noexcept {
    if (count == 0) {
        directions[0] = direction;
        target = place;
        count = 1;
        return;
    }
    if (count == 3) return;
    Point across = direction;
    double value = dot(direction, place);
    for (int k = 0; k < count; ++k) {
        const Point& n = directions[static_cast<std::size_t>(k)];
        const double share = dot(direction, n);
        for (std::size_t axis = 0; axis < 3; ++axis) across[axis] -= share * n[axis];
        value -= share * dot(n, target);
    }
    const double length = std::sqrt(dot(across, across));
    constexpr double least = 1e-6;  // directions closer to those that are held are the same
    if (length < least) return;
    for (double& component : across) component /= length;
    const double missing = value / length - dot(across, target);
    for (std::size_t axis = 0; axis < 3; ++axis) target[axis] += missing * across[axis];
    directions[static_cast<std::size_t>(count++)] = across;
}

void HeldNode::add_all(const Point& place) noexcept {
    if (count == 0) {
        directions = axes;
        target = place;
        count = 3;
        return;
    }
    for (const Point& axis : axes) add(axis, place);
}

Holds::Holds(const Scene& scene, const kernels::NodeNumbering& numbering)
    : place_of_node_(static_cast<std::size_t>(numbering.node_count), -1), filter_is_known_(scene.prescribed.empty()) {
    for (const PrescribedDisplacement& given : scene.prescribed) {
        const std::int32_t node = numbering.internal_of_user[given.node];
        if (!numbering.is_free(node)) {
            throw Error("scene: prescribed displacement of node " + std::to_string(given.node) +
                        ": the node is fixed for good");
        }
        const auto axis = static_cast<std::size_t>(given.axis);
        prescribed_.push_back({.node = node,
                               .user_node = given.node,
                               .axis = axis,
                               .rest = scene.mesh.nodes()[given.node][axis],
                               .displacement = given.displacement});
    }
}

void Holds::prescribe(const PrescribedDisplacement& prescribed, std::int32_t node, double rest) {
    prescribed_.push_back({.node = node,
                           .user_node = prescribed.node,
                           .axis = static_cast<std::size_t>(prescribed.axis),
                           .rest = rest,
                           .displacement = prescribed.displacement});
    filter_is_known_ = false;
}

void Holds::forget(std::int32_t node) {
    std::erase_if(prescribed_, [&](const Prescribed& prescribed) { return prescribed.node == node; });
    std::erase_if(contacts_, [&](const Contact& contact) { return contact.node == node; });
    release(node);
}

bool Holds::hold(std::int32_t node, const Point& target, const Point& direction) {
    const auto held = std::find_if(holds_.begin(), holds_.end(), [&](const Hold& h) { return h.node == node; });
    if (held != holds_.end()) {
        const bool same_direction = held->direction == direction;
        *held = {node, target, direction};
        if (same_direction) return false;
    } else {
        holds_.push_back({node, target, direction});
    }
    filter_is_known_ = false;
    return true;
}

void Holds::release(std::int32_t node) {
    std::erase_if(holds_, [&](const Hold& hold) { return hold.node == node; });
    filter_is_known_ = false;
}

void Holds::release_all() {
    holds_.clear();
    filter_is_known_ = false;
}

void Holds::set_contacts(std::span<const Contact> contacts, const Point& normal, bool changed) {
    contacts_.assign(contacts.begin(), contacts.end());
    normal_ = normal;
    if (changed) filter_is_known_ = false;
}

HeldNode& Holds::active(std::int32_t node) {
    std::int32_t& place = place_of_node_[node];
    if (place < 0) {
        place = static_cast<std::int32_t>(active_.size());
        active_.push_back({.node = node});
    }
    return active_[place];
}

void Holds::prepare(const kernels::NodeNumbering& numbering, double time) {
    for (const HeldNode& held : active_) place_of_node_[held.node] = -1;
    active_.clear();
    const kernels::SleepingNodes& sleeping = numbering.sleeping;
    for (const Prescribed& prescribed : prescribed_) {
        if (sleeping.has(prescribed.node)) continue;
        Point place{0, 0, 0};
        place[prescribed.axis] = prescribed.rest + prescribed.displacement(time);
        if (!std::isfinite(place[prescribed.axis])) {
            throw Error("prescribed displacement of node " + std::to_string(prescribed.user_node) + ", axis " +
                        std::to_string(prescribed.axis) + ": not finite at " + std::to_string(time) + " s");
        }
        active(prescribed.node).add(axes[prescribed.axis], place);
    }
    for (const Hold& hold : holds_) {
        if (sleeping.has(hold.node)) continue;
        if (hold.direction == Point{0, 0, 0}) {
            active(hold.node).add_all(hold.target);
        } else {
            active(hold.node).add(hold.direction, hold.target);
        }
    }
    for (const Contact& contact : contacts_) {
        if (!sleeping.has(contact.node)) active(contact.node).add(normal_, contact.place);
    }
    if (filter_is_known_) return;

    std::vector<NodeConstraint> constraints;
    constraints.reserve(active_.size());
    for (const HeldNode& held : active_) {
        std::array<double, 6> free{};
        if (held.count < 3) {
            free = {1, 1, 1, 0, 0, 0};
            for (int k = 0; k < held.count; ++k) {
                const Point& n = held.directions[static_cast<std::size_t>(k)];
                free[0] -= n[0] * n[0];
                free[1] -= n[1] * n[1];
                free[2] -= n[2] * n[2];
                free[3] -= n[0] * n[1];
                free[4] -= n[0] * n[2];
                free[5] -= n[1] * n[2];
            }
        }
        constraints.push_back({held.node, free});
    }
    for (std::int32_t node = 0; node < numbering.free_count && !sleeping.empty(); ++node) {
        if (sleeping.has(node)) constraints.push_back({node, {}});
    }
    filter_ = ConstraintFilter(std::move(constraints), numbering);
    filter_is_known_ = true;
}

void Holds::apply(std::span<const double> position, std::span<double> velocity, double h) const noexcept {
    for (const HeldNode& held : active_) {
        const std::size_t at = 4 * static_cast<std::size_t>(held.node);
        Point wanted;
        for (std::size_t axis = 0; axis < 3; ++axis) wanted[axis] = (held.target[axis] - position[at + axis]) / h;
        if (held.count == 3) {
            std::copy_n(wanted.begin(), 3, &velocity[at]);
            continue;
        }
        for (int k = 0; k < held.count; ++k) {
            const Point& n = held.directions[static_cast<std::size_t>(k)];
            double along = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) along += n[axis] * (wanted[axis] - velocity[at + axis]);
            for (std::size_t axis = 0; axis < 3; ++axis) velocity[at + axis] += along * n[axis];
        }
    }
}

std::vector<double> Holds::save() const {
    std::vector<double> numbers{static_cast<double>(holds_.size())};
    for (const Hold& hold : holds_) {
        numbers.push_back(hold.node);
        numbers.insert(numbers.end(), hold.target.begin(), hold.target.end());
        numbers.insert(numbers.end(), hold.direction.begin(), hold.direction.end());
    }
    numbers.insert(numbers.end(), normal_.begin(), normal_.end());
    for (const Contact& contact : contacts_) {
        numbers.push_back(contact.node);
        numbers.insert(numbers.end(), contact.place.begin(), contact.place.end());
    }
    return numbers;
}

void Holds::restore(std::span<const double> numbers) {
    const auto next = [&] {
        const double number = numbers.front();
        numbers = numbers.subspan(1);
        return number;
    };
    const auto next_point = [&] {
        Point point;
        for (double& component : point) component = next();
        return point;
    };
    holds_.clear();
    contacts_.clear();
    for (auto left = static_cast<std::size_t>(next()); left > 0; --left) {
        const auto node = static_cast<std::int32_t>(next());
        const Point target = next_point(), direction = next_point();
        holds_.push_back({node, target, direction});
    }
    normal_ = next_point();
    while (!numbers.empty()) {
        const auto node = static_cast<std::int32_t>(next());
        contacts_.push_back({node, next_point()});
    }
    filter_is_known_ = false;
}

std::size_t Holds::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(prescribed_) + heap_bytes(holds_) + heap_bytes(contacts_) + heap_bytes(active_) +
           heap_bytes(place_of_node_);
}

}  // namespace lancet::runtime
