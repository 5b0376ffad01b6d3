// Where points of the material are beside blended fronts, and what is drawn there.
#include "lancet/mesh/cut/front_blend.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "lancet/mesh/cut/part_geometry.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::test {
namespace {

using mesh::CutMesh;
using mesh::CutSurface;
using mesh::FrontBlend;
using mesh::Fronts;
using mesh::Point;

const Point border{0.43, 0, 0.56}, normal{0.1, 0.05, 1};

double height(const Point& x) {
    return normal[0] * (x[0] - border[0]) + normal[1] * (x[1] - border[1]) + normal[2] * (x[2] - border[2]);
}

/// Along the plane, from the front into the cut.
const Point inward{-1, 0, 0.1};

double behind_front(const Point& x) {
    return inward[0] * (x[0] - border[0]) + inward[1] * (x[1] - border[1]) + inward[2] * (x[2] - border[2]);
}

/// A box cut from x = 0 to the border, or farther.
CutMesh half_cut(mesh::Split split, double shift = 0) {
    CutMesh cut(mesh::box({.cells = {4, 4, 4}, .split = split}));
    cut.cut(CutSurface::half_plane({border[0] + shift, border[1], border[2] - 0.1 * shift}, normal, inward));
    return cut;
}

// The points of an element together hang on its copies as its lanes do: int phi_k over all of it, counted at the
// middles of 20^3 / 6 small tetrahedra.
TEST(FrontBlend, HoldsPointsAsTheLanesDo) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        const CutMesh cut = half_cut(split);
        const mesh::Lanes lanes = mesh::lanes(cut, Fronts::blended);
        const FrontBlend blend(cut, Fronts::blended);
        ASSERT_FALSE(lanes.opened_from.empty());
        std::map<std::int32_t, std::map<std::int32_t, double>> expected, found;  // by element and copy
        for (const mesh::Lanes::Lane& lane : lanes.lanes) {
            for (std::size_t k = 0; k < 4; ++k) expected[lane.element][lane.copies[k]] += lane.moments.first[k];
        }
        constexpr int n = 20;
        int opened = 0;
        for (const auto& [element, weights] : expected) {
            bool is_open = false;
            for (const std::int32_t part : cut.parts_of_element(element)) is_open |= blend.opening(part) != nullptr;
            if (!is_open) continue;
            ++opened;
            double volume = 0;
            std::map<std::int32_t, double> sum;
            for (int i = 0; i < n; ++i) {
                for (int j = 0; i + j < n; ++j) {
                    for (int k = 0; i + j + k < n; ++k) {
                        const double a = (i + 0.25) / n, b = (j + 0.25) / n, c = (k + 0.25) / n;
                        const auto hold = blend.hold(cut, cut.material_point(element, {a, b, c, 1 - a - b - c}));
                        volume += 1;
                        double total = 0;
                        for (std::size_t w = 0; w < static_cast<std::size_t>(hold.count); ++w) {
                            sum[hold.copies[w]] += hold.weights[w];
                            total += hold.weights[w];
                        }
                        EXPECT_NEAR(total, 1, 1e-15);
                    }
                }
            }
            // The plane passes through the small tetrahedra of a layer: their share is some 3 / n, of which it takes
            // half, and the shape functions are below one.
            for (const auto& [copy, weight] : weights) EXPECT_NEAR(sum[copy] / volume, weight, 1.5 / n);
            for (const auto& [copy, weight] : sum) EXPECT_TRUE(weights.contains(copy));
        }
        EXPECT_GT(opened, 10);
    }
}

TEST(FrontBlend, SharpPointsHangOnTheirParts) {
    const CutMesh cut = half_cut(mesh::Split::five);
    const FrontBlend blend;
    const mesh::MaterialPoint point = cut.material_point(7, {0.1, 0.2, 0.3, 0.4});
    const mesh::CopyWeights hold = blend.hold(cut, point);
    ASSERT_EQ(hold.count, 4);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(hold.copies[k], cut.parts()[static_cast<std::size_t>(point.part)][k]);
        EXPECT_EQ(hold.weights[k], point.weights[k]);
    }
}

/// Places with the wound open: what is above the plane moves up, and what is below it down. The first copy of a node is
/// on its own side, a further one, or one that is opening, on the other.
std::vector<Point> open_wound(const CutMesh& cut, const mesh::Lanes& lanes) {
    std::vector<Point> positions;
    for (const std::int32_t node : lanes.node_of_copy) {
        const Point& rest = cut.mesh().nodes()[static_cast<std::size_t>(node)];
        const bool is_first = positions.size() < cut.mesh().nodes().size();
        positions.push_back(rest);
        positions.back()[2] += (height(rest) > 0) == is_first ? 0.05 : -0.05;
    }
    return positions;
}

// What is at one place at rest stays together unless it is on the two walls of the wound: nothing tears. The walls are
// apart, and meet where the cut ends.
TEST(FrontBlend, DrawnWoundsAreOpenToTheirTipAndNothingTears) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        const CutMesh cut = half_cut(split);
        const mesh::Lanes lanes = mesh::lanes(cut, Fronts::blended);
        const mesh::PartGeometry geometry = part_geometry(cut, FrontBlend(cut, Fronts::blended));
        ASSERT_FALSE(geometry.opened.empty());
        const std::vector<Point> rest = [&] {
            std::vector<Point> at_rest;
            for (const std::int32_t node : lanes.node_of_copy) {
                at_rest.push_back(cut.mesh().nodes()[static_cast<std::size_t>(node)]);
            }
            return place(geometry, cut, at_rest);
        }();
        const std::vector<Point> x = place(geometry, cut, open_wound(cut, lanes));
        std::map<std::array<long, 3>, std::vector<std::size_t>> together;
        for (std::size_t p = 0; p < rest.size(); ++p) {
            together[{std::lround(1e7 * rest[p][0]), std::lround(1e7 * rest[p][1]), std::lround(1e7 * rest[p][2])}]
                .push_back(p);
        }
        const auto distance = [&](std::size_t a, std::size_t b) {
            return std::hypot(x[a][0] - x[b][0], x[a][1] - x[b][1], x[a][2] - x[b][2]);
        };
        int tip = 0, open_near_tip = 0;
        for (const auto& [key, points] : together) {
            std::vector<std::size_t> apart{points.front()};
            for (const std::size_t p : points) {
                if (std::ranges::all_of(apart, [&](std::size_t q) { return distance(p, q) > 1e-9; })) {
                    apart.push_back(p);
                }
            }
            const Point& at_rest = rest[points.front()];
            const bool is_on_plane = std::abs(height(at_rest)) < 1e-9;
            const double behind = behind_front(at_rest);
            if (!is_on_plane || behind < 1e-9) {
                EXPECT_EQ(apart.size(), 1U) << at_rest[0] << ' ' << at_rest[1] << ' ' << at_rest[2];
                if (is_on_plane) ++tip;
                continue;
            }
            EXPECT_EQ(apart.size(), 2U) << at_rest[0] << ' ' << at_rest[1] << ' ' << at_rest[2];
            if (behind < 0.25) ++open_near_tip;
        }
        EXPECT_GT(tip, 4);
        EXPECT_GT(open_near_tip, 0);
    }
}

// As the front moves on by little, so does every point.
TEST(FrontBlend, PointsMoveContinuouslyWithTheFront) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        constexpr int steps = 100;
        std::vector<double> before;
        double largest = 0, travelled = 0;
        for (int step = 0; step <= steps; ++step) {
            const CutMesh cut = half_cut(split, 0.25 * step / steps);
            const mesh::Lanes lanes = mesh::lanes(cut, Fronts::blended);
            const FrontBlend blend(cut, Fronts::blended);
            const std::vector<Point> positions = open_wound(cut, lanes);
            std::vector<double> now;
            for (std::int32_t element = 0; element < static_cast<std::int32_t>(cut.mesh().tetrahedra().size());
                 ++element) {
                const mesh::Barycentric place{0.3, 0.2, 0.1, 0.4};
                now.push_back(blend.hold(cut, cut.material_point(element, place)).place(positions)[2]);
            }
            for (std::size_t k = 0; k < before.size(); ++k) {
                largest = std::max(largest, std::abs(now[k] - before[k]));
                travelled += std::abs(now[k] - before[k]);
            }
            before = now;
        }
        EXPECT_GT(travelled, 0.1);
        // A corner goes from closed to open, 0.1 apart, over some cell of 0.25, which takes a hundred steps; the
        // smallest sections open fastest.
        EXPECT_LT(largest, 0.02);
    }
}

}  // namespace
}  // namespace lancet::test
