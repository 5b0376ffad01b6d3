#include "lancet/runtime/collide/response.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

double push(const Penalty& penalty, double depth, double depth_rate) noexcept {
    return std::max(0.0, penalty.stiffness * depth + penalty.damping * depth_rate);
}

template <class Primitive, std::size_t Corners>
Point interpolate(const Primitive& corners, const std::array<double, Corners>& weights,
                  std::span<const Point> values) noexcept {
    Point sum{};
    for (std::size_t corner = 0; corner < Corners; ++corner) {
        sum = add_scaled(sum, weights[corner], values[corners[corner]]);
    }
    return sum;
}

template <std::size_t Corners>
double squares(const std::array<double, Corners>& weights) noexcept {
    double sum = 0;
    for (const double weight : weights) sum += weight * weight;
    return sum;
}

void append_hold(std::int32_t node, double distance, const Point& normal, std::span<const Point> positions,
                 std::vector<ContactHold>& holds) {
    // A direction that points where the node goes, so that the farthest is the one with the largest product.
    const Point direction = distance < 0 ? scale(normal, -1) : normal;
    holds.push_back({node, add_scaled(positions[static_cast<std::size_t>(node)], distance, normal), direction});
}

/// Leaves one hold for each node: that which moves it farthest, of equal ones the first.
void keep_farthest(std::span<const Point> positions, std::vector<ContactHold>& holds) {
    const auto distance = [&](const ContactHold& hold) {
        return dot(subtract(hold.target, positions[static_cast<std::size_t>(hold.node)]), hold.direction);
    };
    std::ranges::sort(holds, [&](const ContactHold& a, const ContactHold& b) {
        if (a.node != b.node) return a.node < b.node;
        const double of_a = distance(a), of_b = distance(b);
        if (of_a != of_b) return of_a > of_b;
        return a.direction < b.direction;
    });
    const auto same_node = [](const ContactHold& a, const ContactHold& b) { return a.node == b.node; };
    holds.erase(std::ranges::unique(holds, same_node).begin(), holds.end());
}

}  // namespace

void validate(const Penalty& penalty) {
    for (const double value : {penalty.stiffness, penalty.damping}) {
        if (value >= 0 && std::isfinite(value)) continue;
        throw Error("contact: a stiffness or damping of " + std::to_string(value) + "; expected 0 or more");
    }
}

Wrench add_penalty_forces(std::span<const ToolContact> contacts, const Penalty& penalty,
                          std::span<const mesh::Triangle> triangles, std::span<const Point> velocities,
                          const RigidVelocity& tool, std::span<Point> forces) {
    Wrench on_tool;
    for (const ToolContact& contact : contacts) {
        const mesh::Triangle& triangle = triangles[static_cast<std::size_t>(contact.triangle)];
        const Point arm = subtract(contact.place, tool.about);
        double rate = 0;
        if (!velocities.empty()) {
            const Point surface = interpolate(triangle, contact.weights, velocities);
            rate = dot(subtract(surface, add(tool.linear, cross(tool.angular, arm))), contact.normal);
        }
        const Point force = scale(contact.normal, contact.share * push(penalty, contact.depth, rate));
        for (std::size_t corner = 0; corner < 3; ++corner) {
            Point& at = forces[triangle[corner]];
            at = add_scaled(at, -contact.weights[corner], force);
        }
        on_tool.force = add(on_tool.force, force);
        on_tool.moment = add(on_tool.moment, cross(arm, force));
    }
    return on_tool;
}

void add_penalty_forces(std::span<const VertexContact> contacts, const Penalty& penalty,
                        std::span<const mesh::Tetrahedron> second_tetrahedra, std::span<const Point> first_velocities,
                        std::span<const Point> second_velocities, std::span<Point> first_forces,
                        std::span<Point> second_forces) {
    for (const VertexContact& contact : contacts) {
        const mesh::Tetrahedron& element = second_tetrahedra[static_cast<std::size_t>(contact.tetrahedron)];
        double rate = 0;
        if (!first_velocities.empty() && !second_velocities.empty()) {
            const Point around = interpolate(element, contact.weights, second_velocities);
            rate = dot(subtract(around, first_velocities[contact.vertex]), contact.normal);
        }
        const Point force = scale(contact.normal, push(penalty, contact.depth, rate));
        Point& on_vertex = first_forces[contact.vertex];
        on_vertex = add(on_vertex, force);
        for (std::size_t corner = 0; corner < 4; ++corner) {
            Point& at = second_forces[element[corner]];
            at = add_scaled(at, -contact.weights[corner], force);
        }
    }
}

double penalty_energy(std::span<const ToolContact> contacts, const Penalty& penalty) noexcept {
    double sum = 0;
    for (const ToolContact& contact : contacts) sum += contact.share * contact.depth * contact.depth;
    return penalty.stiffness * sum / 2;
}

double penalty_energy(std::span<const VertexContact> contacts, const Penalty& penalty) noexcept {
    double sum = 0;
    for (const VertexContact& contact : contacts) sum += contact.depth * contact.depth;
    return penalty.stiffness * sum / 2;
}

void tool_holds(std::span<const ToolContact> contacts, std::span<const mesh::Triangle> triangles,
                std::span<const Point> positions, std::vector<ContactHold>& holds) {
    holds.clear();
    for (const ToolContact& contact : contacts) {
        const mesh::Triangle& triangle = triangles[static_cast<std::size_t>(contact.triangle)];
        const double factor = -contact.depth / squares(contact.weights);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            if (contact.weights[corner] == 0) continue;
            append_hold(triangle[corner], factor * contact.weights[corner], contact.normal, positions, holds);
        }
    }
    keep_farthest(positions, holds);
}

void vertex_holds(std::span<const VertexContact> contacts, std::span<const mesh::Tetrahedron> second_tetrahedra,
                  std::span<const Point> first_positions, std::span<const Point> second_positions,
                  std::vector<ContactHold>& first_holds, std::vector<ContactHold>& second_holds) {
    first_holds.clear();
    second_holds.clear();
    for (const VertexContact& contact : contacts) {
        const double s = contact.depth / (1 + squares(contact.weights));
        append_hold(contact.vertex, s, contact.normal, first_positions, first_holds);
        const mesh::Tetrahedron& element = second_tetrahedra[static_cast<std::size_t>(contact.tetrahedron)];
        for (std::size_t corner = 0; corner < 4; ++corner) {
            append_hold(element[corner], -s * contact.weights[corner], contact.normal, second_positions, second_holds);
        }
    }
    keep_farthest(first_positions, first_holds);
    keep_farthest(second_positions, second_holds);
}

}  // namespace lancet::runtime
