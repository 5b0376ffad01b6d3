#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/runtime/simulate/body.hpp"

namespace lancet::runtime {

/// When an island that hardly moves is not computed any more: a body, or a piece that nothing connects with the rest
/// of it. It wakes by a load, a touch or a cut.
struct SleepOptions {
    double speed = 0;    ///< m / s: of its fastest node; 0: nothing sleeps
    double after = 0.5;  ///< s of such rest
};

/// The islands of a body, connected components of its elements, which come to rest and sleep each on its own. Which
/// nodes sleep, the body itself knows (DeformableBody::set_asleep): it is an argument where that is asked or changed.
class Islands {
  public:
    Islands() = default;
    /// - component: [node] of the body, any numbers. A node without mass is of no island.
    /// - restless: nodes whose islands never rest
    Islands(const DeformableBody& body, std::span<const std::int32_t> component,
            std::span<const std::int32_t> restless);

    int count() const noexcept { return static_cast<int>(islands_.size()); }
    /// The island of a node; -1: none. They are numbered in the order of their lowest nodes.
    std::int32_t of_node(std::int32_t node) const {
        return of_node_.empty() ? -1 : of_node_[static_cast<std::size_t>(node)];
    }

    bool is_asleep(const DeformableBody& body, int island) const;
    bool are_asleep(const DeformableBody& body) const;
    /// Whether the island of a node is asleep, or on the way to it.
    bool is_quiet(const DeformableBody& body, std::int32_t node) const;

    /// Wakes the islands of some nodes, which start to rest anew.
    void wake(DeformableBody& body, std::span<const std::int32_t> nodes);
    void wake(DeformableBody& body);
    /// Takes up that the body has moved for some seconds: islands fall asleep, or count towards it. Allocates where one
    /// does, and the first time.
    void rest(DeformableBody& body, const SleepOptions& options, double seconds);

    /// The islands before a cut, for those after it.
    struct Before;
    Before before(const DeformableBody& body) const;
    /// Goes on after a cut as before, but for islands that it has touched: they are awake.
    /// - touched: nodes of elements that the cut has touched; new nodes are touched anyway
    void go_on(DeformableBody& body, const Before& before, std::span<const std::int32_t> touched);

  private:
    struct Island {
        std::int32_t node = 0;  ///< the lowest
        bool is_restless = false;
        double rested = 0;  ///< s
        double square = 0;  ///< of the velocity of its fastest node, while that is looked for
    };
    void put_to_sleep(DeformableBody& body, std::span<const std::uint8_t> asleep);

    std::vector<std::int32_t> of_node_;
    std::vector<Island> islands_;
    std::vector<std::uint8_t> asleep_, sleepers_;  ///< [island], [node]: while they are changed
    std::vector<Point> velocities_;
};

struct Islands::Before {
    std::int32_t kept_nodes = 0;          ///< nodes before this one are what they were
    std::vector<std::int32_t> of_node{};  ///< their islands
    std::vector<double> rested{};         ///< [island] s
    std::vector<std::uint8_t> asleep{};   ///< [island]
};

}  // namespace lancet::runtime
