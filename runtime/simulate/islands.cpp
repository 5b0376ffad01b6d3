#include "lancet/runtime/simulate/islands.hpp"

#include <algorithm>
#include <limits>

namespace lancet::runtime {

Islands::Islands(const DeformableBody& body, std::span<const std::int32_t> component,
                 std::span<const std::int32_t> restless)
    : of_node_(component.size(), -1) {
    const std::int32_t highest = component.empty() ? -1 : *std::ranges::max_element(component);
    std::vector<std::int32_t> number(static_cast<std::size_t>(highest) + 1, -1);
    for (std::size_t node = 0; node < component.size(); ++node) {
        if (body.nodal_mass(static_cast<std::int32_t>(node)) == 0) continue;
        std::int32_t& island = number[static_cast<std::size_t>(component[node])];
        if (island < 0) {
            island = count();
            islands_.push_back({.node = static_cast<std::int32_t>(node)});
        }
        of_node_[node] = island;
    }
    for (const std::int32_t node : restless) {
        if (of_node(node) >= 0) islands_[static_cast<std::size_t>(of_node(node))].is_restless = true;
    }
}

bool Islands::is_asleep(const DeformableBody& body, int island) const {
    return body.is_asleep(islands_[static_cast<std::size_t>(island)].node);
}

bool Islands::are_asleep(const DeformableBody& body) const {
    return !islands_.empty() &&
           std::ranges::all_of(islands_, [&](const Island& island) { return body.is_asleep(island.node); });
}

bool Islands::is_quiet(const DeformableBody& body, std::int32_t node) const {
    const std::int32_t island = of_node(node);
    return island < 0 || islands_[static_cast<std::size_t>(island)].rested > 0 || is_asleep(body, island);
}

void Islands::put_to_sleep(DeformableBody& body, std::span<const std::uint8_t> asleep) {
    sleepers_.resize(of_node_.size());
    for (std::size_t node = 0; node < of_node_.size(); ++node) {
        // What is of no island does not move: no block has to be awake for it.
        sleepers_[node] = of_node_[node] < 0 ? 1 : asleep[static_cast<std::size_t>(of_node_[node])];
    }
    if (std::ranges::count(asleep, std::uint8_t{1}) == 0) std::ranges::fill(sleepers_, std::uint8_t{0});
    body.set_asleep(sleepers_);
}

void Islands::wake(DeformableBody& body, std::span<const std::int32_t> nodes) {
    bool wakes = false;
    for (const std::int32_t node : nodes) {
        if (of_node(node) < 0) continue;
        islands_[static_cast<std::size_t>(of_node(node))].rested = 0;
        wakes = wakes || is_asleep(body, of_node(node));
    }
    if (!wakes) return;
    asleep_.resize(islands_.size());
    for (int island = 0; island < count(); ++island) {
        asleep_[static_cast<std::size_t>(island)] = is_asleep(body, island) ? 1 : 0;
    }
    for (const std::int32_t node : nodes) {
        if (of_node(node) >= 0) asleep_[static_cast<std::size_t>(of_node(node))] = 0;
    }
    put_to_sleep(body, asleep_);
}

void Islands::wake(DeformableBody& body) {
    if (islands_.empty()) return;
    for (Island& island : islands_) island.rested = 0;
    asleep_.assign(islands_.size(), 0);
    put_to_sleep(body, asleep_);
}

void Islands::rest(DeformableBody& body, const SleepOptions& options, double seconds) {
    velocities_.resize(of_node_.size());
    body.velocities(velocities_);
    for (Island& island : islands_) island.square = 0;
    for (std::size_t node = 0; node < velocities_.size(); ++node) {
        if (of_node_[node] < 0) continue;
        const Point& v = velocities_[node];
        double& square = islands_[static_cast<std::size_t>(of_node_[node])].square;
        square = std::max(square, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    asleep_.resize(islands_.size());
    bool falls_asleep = false;
    for (int number = 0; number < count(); ++number) {
        Island& island = islands_[static_cast<std::size_t>(number)];
        std::uint8_t& asleep = asleep_[static_cast<std::size_t>(number)];
        asleep = is_asleep(body, number) ? 1 : 0;
        if (asleep != 0 || island.is_restless) continue;
        island.rested = island.square < options.speed * options.speed ? island.rested + seconds : 0;
        if (island.rested < options.after) continue;
        asleep = 1;
        falls_asleep = true;
    }
    if (falls_asleep) put_to_sleep(body, asleep_);
}

Islands::Before Islands::before(const DeformableBody& body) const {
    Before before{.of_node = of_node_};
    for (int island = 0; island < count(); ++island) {
        before.rested.push_back(islands_[static_cast<std::size_t>(island)].rested);
        before.asleep.push_back(is_asleep(body, island) ? 1 : 0);
    }
    return before;
}

void Islands::go_on(DeformableBody& body, const Before& before, std::span<const std::int32_t> touched) {
    for (Island& island : islands_) island.rested = std::numeric_limits<double>::infinity();
    asleep_.assign(islands_.size(), 1);
    const auto is_awake = [&](std::int32_t node) {
        if (of_node(node) < 0) return;
        islands_[static_cast<std::size_t>(of_node(node))].rested = 0;
        asleep_[static_cast<std::size_t>(of_node(node))] = 0;
    };
    for (std::size_t node = 0; node < of_node_.size(); ++node) {
        const auto number = static_cast<std::int32_t>(node);
        const std::int32_t was = number < before.kept_nodes ? before.of_node[node] : -1;
        if (was < 0) {
            is_awake(number);
            continue;
        }
        if (of_node(number) < 0) continue;
        double& rested = islands_[static_cast<std::size_t>(of_node(number))].rested;
        rested = std::min(rested, before.rested[static_cast<std::size_t>(was)]);
        if (before.asleep[static_cast<std::size_t>(was)] == 0) asleep_[static_cast<std::size_t>(of_node(number))] = 0;
    }
    for (const std::int32_t node : touched) is_awake(node);
    put_to_sleep(body, asleep_);
}

}  // namespace lancet::runtime
