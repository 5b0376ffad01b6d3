#include "lancet/mesh/embed/polygon_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lancet::mesh {

namespace {

using Corners = std::vector<std::int32_t>;

/// Places seen along the axis that is nearest to the normal, counter-clockwise kept.
class View {
  public:
    View(std::span<const Point> places, const Point& normal) : places_(places) {
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
        }
        u_ = (axis + 1) % 3;
        v_ = (axis + 2) % 3;
        if (normal[axis] < 0) std::swap(u_, v_);
    }

    /// Twice the signed area.
    double area(std::int32_t a, std::int32_t b, std::int32_t c) const {
        return (u(b) - u(a)) * (v(c) - v(a)) - (v(b) - v(a)) * (u(c) - u(a));
    }
    double area(const Corners& loop) const {
        double sum = 0;
        for (std::size_t k = 2; k < loop.size(); ++k) sum += area(loop[0], loop[k - 1], loop[k]);
        return sum;
    }
    double square(std::int32_t a, std::int32_t b) const {
        return (u(b) - u(a)) * (u(b) - u(a)) + (v(b) - v(a)) * (v(b) - v(a));
    }
    /// The crossings of the ray from a place along u with a loop are odd.
    bool is_inside(std::int32_t place, const Corners& loop) const {
        bool is_odd = false;
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const std::int32_t a = loop[k], b = loop[(k + 1) % loop.size()];
            if ((v(a) > v(place)) == (v(b) > v(place))) continue;
            const double at = u(a) + (v(place) - v(a)) / (v(b) - v(a)) * (u(b) - u(a));
            if (at > u(place)) is_odd = !is_odd;
        }
        return is_odd;
    }
    /// Two segments have inner points in common.
    bool cross(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) const {
        if (a == c || a == d || b == c || b == d) return false;
        return (area(a, b, c) > 0) != (area(a, b, d) > 0) && (area(c, d, a) > 0) != (area(c, d, b) > 0);
    }

  private:
    double u(std::int32_t n) const { return places_[static_cast<std::size_t>(n)][u_]; }
    double v(std::int32_t n) const { return places_[static_cast<std::size_t>(n)][v_]; }

    std::span<const Point> places_;
    std::size_t u_ = 0, v_ = 1;
};

/// Cuts a hole open to the loop around it, by a bridge that runs there and back.
void join(Corners& outer, const Corners& hole, const View& view) {
    std::size_t best_outer = 0, best_hole = 0;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < outer.size(); ++i) {
        for (std::size_t j = 0; j < hole.size(); ++j) {
            const double length = view.square(outer[i], hole[j]);
            if (length >= shortest) continue;
            const auto blocks = [&](const Corners& loop) {
                for (std::size_t k = 0; k < loop.size(); ++k) {
                    if (view.cross(outer[i], hole[j], loop[k], loop[(k + 1) % loop.size()])) return true;
                }
                return false;
            };
            if (blocks(outer) || blocks(hole)) continue;
            shortest = length;
            best_outer = i;
            best_hole = j;
        }
    }
    Corners bridge;
    for (std::size_t k = 0; k <= hole.size(); ++k) bridge.push_back(hole[(best_hole + k) % hole.size()]);
    bridge.push_back(outer[best_outer]);
    outer.insert(outer.begin() + static_cast<std::ptrdiff_t>(best_outer) + 1, bridge.begin(), bridge.end());
}

void cut_ears(Corners loop, const View& view, std::vector<Triangle>& triangles) {
    while (loop.size() > 3) {
        const std::size_t count = loop.size();
        std::size_t best = 0;
        double best_quality = -std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < count; ++k) {
            const std::int32_t a = loop[(k + count - 1) % count], b = loop[k], c = loop[(k + 1) % count];
            const double square = view.square(a, b) + view.square(b, c) + view.square(c, a);
            double quality = square > 0 ? view.area(a, b, c) / square : 0;
            // Corners on the new side count as inside: they would be left without an area.
            const double margin = 1e-9 * square;
            const bool is_blocked = quality > 0 && std::ranges::any_of(loop, [&](std::int32_t p) {
                                        return p != a && p != b && p != c && view.area(a, b, p) > -margin &&
                                               view.area(b, c, p) > -margin && view.area(c, a, p) > -margin;
                                    });
            if (is_blocked) quality = -1 - 1 / quality;  // worse than any turned one, the least bad first
            if (quality <= best_quality) continue;
            best_quality = quality;
            best = k;
        }
        triangles.push_back({loop[(best + count - 1) % count], loop[best], loop[(best + 1) % count]});
        loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
    }
    if (loop.size() == 3) triangles.push_back({loop[0], loop[1], loop[2]});
}

}  // namespace

void add_triangles(std::span<const std::vector<std::int32_t>> loops, std::span<const Point> places, const Point& normal,
                   std::vector<Triangle>& triangles) {
    const View view(places, normal);
    struct Outer {
        Corners corners;
        double area;
        std::vector<const Corners*> holes{};
    };
    std::vector<Outer> outer;
    std::vector<const Corners*> holes;
    for (const Corners& loop : loops) {
        if (loop.size() < 3) continue;
        const double area = view.area(loop);
        if (area >= 0) {
            outer.push_back({loop, area});
        } else {
            holes.push_back(&loop);
        }
    }
    for (const Corners* hole : holes) {
        Outer* best = nullptr;
        for (Outer& candidate : outer) {
            if (!view.is_inside(hole->front(), candidate.corners)) continue;
            if (best == nullptr || candidate.area < best->area) best = &candidate;
        }
        if (best != nullptr) {
            best->holes.push_back(hole);
        } else {
            cut_ears(*hole, view, triangles);
        }
    }
    for (Outer& region : outer) {
        for (const Corners* hole : region.holes) join(region.corners, *hole, view);
        cut_ears(std::move(region.corners), view, triangles);
    }
}

}  // namespace lancet::mesh
