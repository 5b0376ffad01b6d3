#include "lancet/mesh/embed/loop_mending.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "lancet/mesh/embed/corner_numbers.hpp"

namespace lancet::mesh {

void simplify(std::vector<std::int32_t>& loop) {
    // A stack from which what cancels is taken off, at both ends in turn.
    std::vector<std::int32_t> kept;
    for (const std::int32_t corner : loop) {
        if (!kept.empty() && kept.back() == corner) continue;
        if (kept.size() > 1 && kept[kept.size() - 2] == corner) {
            kept.pop_back();
            continue;
        }
        kept.push_back(corner);
    }
    std::size_t begin = 0;
    while (kept.size() - begin > 1) {
        const std::size_t count = kept.size() - begin;
        if (kept[begin] == kept.back()) {
            kept.pop_back();
        } else if (count > 2 && kept[kept.size() - 2] == kept[begin]) {
            kept.resize(kept.size() - 2);
        } else if (count > 2 && kept[begin + 1] == kept.back()) {
            kept.pop_back();
            ++begin;
        } else {
            break;
        }
    }
    loop.assign(kept.begin() + static_cast<std::ptrdiff_t>(begin), kept.end());
    if (loop.size() < 3) loop.clear();
}

namespace {

class Mender {
  public:
    /// Corners lie on a side where they are no farther than `distance` times the size of an element.
    Mender(const CutMesh& cut, std::span<const MaterialPoint> points, std::span<const Point> at_rest, double distance)
        : cut_(cut), points_(points), at_rest_(at_rest), distance_(distance) {}

    /// Finds unmatched sides. Returns false where there are none, but for those of triangles in several parts, which
    /// have undivided neighbours.
    bool look(const std::vector<PartRegion>& regions) {
        for_each_side(regions,
                      [&](const PartRegion&, std::int32_t a, std::int32_t b) { excess_[key(a, b)] += a < b ? 1 : -1; });
        std::set<std::int32_t> ends;
        bool is_incomplete = false;
        for_each_side(regions, [&](const PartRegion& region, std::int32_t a, std::int32_t b) {
            if (is_matched(a, b)) return;
            ends.insert({a, b});
            is_incomplete = is_incomplete || region.part >= 0;
        });
        for (const std::int32_t vertex : ends) {
            const MaterialPoint& point = points_[static_cast<std::size_t>(vertex)];
            const auto heaviest = std::ranges::max_element(point.weights) - point.weights.begin();
            ends_at_[copies(point.part)[static_cast<std::size_t>(heaviest)]].push_back(vertex);
        }
        return is_incomplete;
    }

    void mend(PartRegion& region) const {
        for (std::vector<std::int32_t>& loop : region.loops) {
            std::vector<std::int32_t> mended;
            for (std::size_t k = 0; k < loop.size(); ++k) {
                const std::int32_t a = loop[k], b = loop[(k + 1) % loop.size()];
                mended.push_back(a);
                if (is_matched(a, b)) continue;
                for (const std::int32_t between : on_side(region.part, a, b)) mended.push_back(between);
            }
            loop = std::move(mended);
        }
    }

  private:
    static std::uint64_t key(std::int32_t a, std::int32_t b) {
        const auto [low, high] = std::minmax(a, b);
        return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
    }
    bool is_matched(std::int32_t a, std::int32_t b) const { return excess_.at(key(a, b)) == 0; }
    const Tetrahedron& copies(std::int32_t part) const { return cut_.parts()[static_cast<std::size_t>(part)]; }

    template <class Use>
    static void for_each_side(const std::vector<PartRegion>& regions, const Use& use) {
        for (const PartRegion& region : regions) {
            for (const std::vector<std::int32_t>& loop : region.loops) {
                for (std::size_t k = 0; k < loop.size(); ++k) use(region, loop[k], loop[(k + 1) % loop.size()]);
            }
        }
    }

    /// True where all copies on which the vertex has a weight are those of the part: it moves with the part. Triangles
    /// in several parts are away from openings.
    bool moves_with(std::int32_t vertex, std::int32_t part) const {
        if (part < 0) return true;
        const MaterialPoint& point = points_[static_cast<std::size_t>(vertex)];
        const Tetrahedron& own = copies(point.part);
        for (std::size_t k = 0; k < 4; ++k) {
            if (std::abs(point.weights[k]) < same_weight) continue;
            if (std::ranges::find(copies(part), own[k]) == copies(part).end()) return false;
        }
        return true;
    }

    std::vector<std::int32_t> on_side(std::int32_t part, std::int32_t a, std::int32_t b) const {
        const Point &from = at_rest_[static_cast<std::size_t>(a)], &to = at_rest_[static_cast<std::size_t>(b)];
        const Point side{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        const double square = side[0] * side[0] + side[1] * side[1] + side[2] * side[2];
        const double tolerance = distance_ * size(part >= 0 ? part : points_[static_cast<std::size_t>(a)].part);
        std::vector<std::pair<double, std::int32_t>> found;
        const auto look_at = [&](const std::vector<std::int32_t>& ends) {
            for (const std::int32_t vertex : ends) {
                if (vertex == a || vertex == b || !moves_with(vertex, part)) continue;
                const Point& x = at_rest_[static_cast<std::size_t>(vertex)];
                const Point away{x[0] - from[0], x[1] - from[1], x[2] - from[2]};
                const double along = (away[0] * side[0] + away[1] * side[1] + away[2] * side[2]) / square;
                if (!(along > 0 && along < 1)) continue;
                const double distance =
                    std::hypot(away[0] - along * side[0], away[1] - along * side[1], away[2] - along * side[2]);
                if (distance < tolerance) found.emplace_back(along, vertex);
            }
        };
        if (part < 0) {
            for (const auto& [copy, ends] : ends_at_) look_at(ends);
        } else {
            for (const std::int32_t copy : copies(part)) {
                const auto ends = ends_at_.find(copy);
                if (ends != ends_at_.end()) look_at(ends->second);
            }
        }
        std::sort(found.begin(), found.end());
        std::vector<std::int32_t> between;
        for (const auto& [along, vertex] : found) between.push_back(vertex);
        return between;
    }

    double size(std::int32_t part) const {
        const Tetrahedron& t =
            cut_.mesh().tetrahedra()[static_cast<std::size_t>(cut_.element_of_part()[static_cast<std::size_t>(part)])];
        const Point& apex = cut_.mesh().nodes()[static_cast<std::size_t>(t[0])];
        double longest = 0;
        for (std::size_t k = 1; k < 4; ++k) {
            const Point& x = cut_.mesh().nodes()[static_cast<std::size_t>(t[k])];
            longest = std::max(longest, std::hypot(x[0] - apex[0], x[1] - apex[1], x[2] - apex[2]));
        }
        return longest;
    }

    const CutMesh& cut_;
    std::span<const MaterialPoint> points_;
    std::span<const Point> at_rest_;
    double distance_;
    std::unordered_map<std::uint64_t, int> excess_;              ///< of sides in one direction over those in the other
    std::map<std::int32_t, std::vector<std::int32_t>> ends_at_;  ///< of unmatched sides, by their heaviest copy
};

}  // namespace

void mend_loops(const CutMesh& cut, std::span<const MaterialPoint> points, std::span<const Point> at_rest,
                std::vector<PartRegion>& regions) {
    // Most corners lie on their sides to rounding. What is left has corners that have become one with others close by:
    // three may have moved, each by same_weight.
    for (const double distance : {0x1p-38, same_weight, 4 * same_weight}) {
        Mender mender(cut, points, at_rest, distance);
        if (!mender.look(regions)) return;
        for (PartRegion& region : regions) mender.mend(region);
    }
}

}  // namespace lancet::mesh
