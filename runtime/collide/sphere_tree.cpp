#include "lancet/runtime/collide/bounding_volume_tree.hpp"
#include "lancet/runtime/collide/broad_phase_kinds.hpp"

namespace lancet::runtime {
namespace {

/// Radii are widened by more than all roundings of centres, radii and distances together, so that no box is missed: a
/// few units in the last place of the largest number involved, here 16 of them.
constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();

double size_of(const Point& at) noexcept {
    return std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2])});
}
double length(double x, double y, double z) noexcept {
    return std::sqrt(x * x + y * y + z * z);
}

struct Sphere {
    Point centre{};
    double radius = -1;  ///< negative: empty

    static Sphere around(const Box& box) noexcept {
        if (!(box.lower[0] <= box.upper[0])) return {};
        Sphere sphere{middle(box), 0};
        sphere.radius =
            length(box.upper[0] - sphere.centre[0], box.upper[1] - sphere.centre[1], box.upper[2] - sphere.centre[2]);
        return sphere.widened();
    }

    /// The smallest sphere around two.
    static Sphere merged(const Sphere& a, const Sphere& b) noexcept {
        if (a.radius < 0) return b;
        if (b.radius < 0) return a;
        const double distance = a.distance_to(b.centre);
        if (distance + b.radius <= a.radius) return a;
        if (distance + a.radius <= b.radius) return b;
        const double radius = (distance + a.radius + b.radius) / 2;
        // distance > 0, or one of them would contain the other.
        const double share = std::clamp((radius - a.radius) / distance, 0.0, 1.0);
        Sphere sphere;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sphere.centre[axis] = a.centre[axis] + share * (b.centre[axis] - a.centre[axis]);
        }
        sphere.radius = std::max(sphere.distance_to(a.centre) + a.radius, sphere.distance_to(b.centre) + b.radius);
        return sphere.widened();
    }

    bool touches(const Box& box) const noexcept {
        if (radius < 0) return false;
        double squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double beside = std::max({box.lower[axis] - centre[axis], centre[axis] - box.upper[axis], 0.0});
            squared += beside * beside;
        }
        return squared <= radius * radius;
    }

  private:
    double distance_to(const Point& place) const noexcept {
        return length(place[0] - centre[0], place[1] - centre[1], place[2] - centre[2]);
    }
    Sphere widened() const noexcept { return {centre, radius + rounding * (radius + size_of(centre))}; }
};

class SphereTree final : public BoundingVolumeTree<Sphere> {
  public:
    BroadPhaseKind kind() const noexcept override { return BroadPhaseKind::sphere_tree; }
};

}  // namespace

std::unique_ptr<BroadPhase> make_sphere_tree() {
    return std::make_unique<SphereTree>();
}

}  // namespace lancet::runtime
