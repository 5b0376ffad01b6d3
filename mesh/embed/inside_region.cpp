#include "lancet/mesh/embed/inside_region.hpp"

#include <algorithm>
#include <map>

namespace lancet::mesh {

namespace {

/// An end of a segment: on an edge of the surface, or on a side of the polygon.
struct End {
    int point = 0;
    std::int32_t edge = -1;
    int side = -1;
};

struct Segment {
    int plane = 0;
    End from{}, to{};
    bool is_used = false;
};

/// An end on the polygon's border.
struct Event {
    std::size_t segment = 0;
    bool is_start = false;
};

class Region {
  public:
    Region(PlanePool& pool, const Polygon& polygon) : pool_(pool), polygon_(polygon), events_(polygon.points.size()) {}

    void add(const PooledTriangle& triangle) {
        const auto sides = [&](int side) {
            return std::ranges::any_of(polygon_.points,
                                       [&](int point) { return pool_.side(triangle.plane, point) == side; });
        };
        if (!sides(1) || !sides(-1)) return;
        Polygon near = polygon_;
        for (const int border : triangle.borders) {
            near = clip(pool_, near, {border, 1});
            if (near.points.empty()) return;
        }
        near = clip(pool_, near, {triangle.plane, -1});
        const std::size_t count = near.points.size();
        for (std::size_t k = 0; k < count; ++k) {
            if (near.edges[k].plane != triangle.plane) continue;
            segments_.push_back({.plane = triangle.plane,
                                 .from = end(triangle, near.points[k], near.edges[(k + count - 1) % count].plane),
                                 .to = end(triangle, near.points[(k + 1) % count], near.edges[(k + 1) % count].plane)});
        }
    }

    bool reaches_border() {
        bool reaches = false;
        for (std::size_t s = 0; s < segments_.size(); ++s) {
            const Segment& segment = segments_[s];
            if (segment.from.side >= 0) events_[static_cast<std::size_t>(segment.from.side)].push_back({s, true});
            if (segment.to.side >= 0) events_[static_cast<std::size_t>(segment.to.side)].push_back({s, false});
            if (segment.from.edge >= 0) starts_[segment.from.edge] = s;
            reaches = reaches || segment.from.side >= 0 || segment.to.side >= 0;
        }
        for (std::size_t side = 0; side < events_.size(); ++side) {
            const int last = polygon_.points[(side + 1) % polygon_.points.size()];
            std::sort(events_[side].begin(), events_[side].end(), [&](const Event& a, const Event& b) {
                // b lies behind a where it is on the same side of a's plane as the last point.
                const int plane = segments_[a.segment].plane;
                if (a.segment == b.segment) return false;
                return pool_.side(plane, point(b)) == pool_.side(plane, last);
            });
        }
        return reaches;
    }

    Loop border() const {
        Loop loop;
        for (const int point : polygon_.points) loop.push_back({point});
        return loop;
    }

    std::optional<std::vector<Loop>> loops() {
        std::vector<Loop> result;
        for (std::size_t first = 0; first < segments_.size(); ++first) {
            if (segments_[first].is_used) continue;
            Loop& loop = result.emplace_back();
            std::size_t at = first;
            do {
                Segment& segment = segments_[at];
                if (segment.is_used) return std::nullopt;
                segment.is_used = true;
                loop.push_back({segment.from.point, segment.from.edge});
                const std::optional<std::size_t> next = after(at, loop);
                if (!next) return std::nullopt;
                at = *next;
            } while (at != first);
        }
        return result;
    }

  private:
    End end(const PooledTriangle& triangle, int point, int plane) const {
        for (std::size_t k = 0; k < 3; ++k) {
            if (triangle.borders[k] == plane) return {.point = point, .edge = triangle.edges[k]};
        }
        for (std::size_t side = 0; side < polygon_.edges.size(); ++side) {
            if (polygon_.edges[side].plane == plane) return {.point = point, .side = static_cast<int>(side)};
        }
        return {.point = point};
    }

    int point(const Event& event) const {
        const Segment& segment = segments_[event.segment];
        return event.is_start ? segment.from.point : segment.to.point;
    }

    /// The segment that follows; adds the corners on the way to it.
    std::optional<std::size_t> after(std::size_t number, Loop& loop) const {
        const End& end = segments_[number].to;
        if (end.edge >= 0) {
            const auto found = starts_.find(end.edge);
            return found == starts_.end() ? std::nullopt : std::optional(found->second);
        }
        if (end.side < 0) return std::nullopt;
        loop.push_back({end.point});
        auto side = static_cast<std::size_t>(end.side);
        std::size_t next = 0;
        while (events_[side][next].segment != number || events_[side][next].is_start) ++next;
        ++next;
        for (std::size_t sides = 0; sides <= events_.size(); ++sides) {
            if (next < events_[side].size()) {
                const Event& event = events_[side][next];
                return event.is_start ? std::optional(event.segment) : std::nullopt;
            }
            side = (side + 1) % events_.size();
            loop.push_back({polygon_.points[side]});
            next = 0;
        }
        return std::nullopt;
    }

    PlanePool& pool_;
    const Polygon& polygon_;
    std::vector<Segment> segments_;
    std::vector<std::vector<Event>> events_;  ///< [side of the polygon], in order along it
    std::map<std::int32_t, std::size_t> starts_;
};

}  // namespace

std::optional<std::vector<Loop>> inside_region(PlanePool& pool, const Polygon& polygon,
                                               std::span<const PooledTriangle> triangles,
                                               const std::function<bool()>& is_border_inside) {
    Region region(pool, polygon);
    for (const PooledTriangle& triangle : triangles) region.add(triangle);
    const bool reaches_border = region.reaches_border();
    std::optional<std::vector<Loop>> loops = region.loops();
    if (loops && !reaches_border && is_border_inside()) loops->push_back(region.border());
    return loops;
}

}  // namespace lancet::mesh
