#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "tests/kernels/surface/surfaces.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::kernels::test {

namespace {

constexpr double unit_roundoff = 0x1p-24;  // of float

class VertexNormals : public ::testing::TestWithParam<InstructionSet> {
  protected:
    void SetUp() override {
        if (!is_executable(GetParam())) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam());
        }
    }

    struct Found {
        std::vector<Place> normals;
        std::vector<bool> is_doubtful;
    };
    /// Batches at once, or as many as `together` in each call.
    Found normals_of(const Surface& surface, int together = 1 << 20) const {
        const VertexRings rings = vertex_rings(surface.places.size(), surface.triangles);
        Found found{.normals = std::vector<Place>(surface.places.size(), Place{7, 7, 7}),
                    .is_doubtful = std::vector<bool>(surface.places.size(), false)};
        std::vector<std::uint16_t> doubtful(static_cast<std::size_t>(rings.batches()), 0xAAAA);
        const VertexNormalArguments arguments{.slot_begin = rings.slot_begin.data(),
                                              .vertices = rings.vertices.data(),
                                              .neighbours = rings.neighbours.data(),
                                              .positions = surface.places.front().data(),
                                              .normals = found.normals.front().data(),
                                              .doubtful = doubtful.data()};
        for (int batch = 0; batch < rings.batches(); batch += together) {
            kernel_set<float>(GetParam())
                .normals.vertex_normals(arguments, batch, std::min(batch + together, rings.batches()));
        }
        for (std::size_t slot = 0; slot < rings.vertices.size(); ++slot) {
            const bool is_doubtful = (doubtful[slot / VertexRings::lanes] >> slot % VertexRings::lanes & 1) != 0;
            found.is_doubtful[static_cast<std::size_t>(rings.vertices[slot] / 3)] = is_doubtful;
        }
        return found;
    }
};

struct Exact {
    Place normal{};
    double length = 0;   ///< of the sum
    double error = 0;    ///< of the sum, as the kernel promises, in units of roundoff
    double largest = 0;  ///< angle
};

/// In long double, with an arctangent for each angle.
std::vector<Exact> exact_normals(const Surface& surface) {
    using Vector = std::array<long double, 3>;
    std::vector<Exact> exact(surface.places.size());
    std::vector<Vector> sums(surface.places.size(), Vector{});
    const auto dot = [](const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    for (const Triangle& triangle : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto vertex = static_cast<std::size_t>(triangle[k]);
            Vector u{}, v{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto place = [&](std::size_t corner) {
                    return static_cast<long double>(
                        surface.places[static_cast<std::size_t>(triangle[corner % 3])][axis]);
                };
                u[axis] = place(k + 1) - place(k);
                v[axis] = place(k + 2) - place(k);
            }
            const Vector n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
            const long double length = std::sqrt(dot(n, n));
            if (!(length > 0)) continue;
            const long double angle = std::atan2(length, dot(u, v));
            for (std::size_t axis = 0; axis < 3; ++axis) sums[vertex][axis] += angle * n[axis] / length;
            Exact& of = exact[vertex];
            const double sine = static_cast<double>(std::sin(angle)), value = static_cast<double>(angle);
            of.error += value < 104 * std::numbers::pi / 180 ? 8 + 40 * value : 64 * value / sine;
            of.largest = std::max(of.largest, value);
        }
    }
    for (std::size_t vertex = 0; vertex < sums.size(); ++vertex) {
        const long double length = std::sqrt(dot(sums[vertex], sums[vertex]));
        exact[vertex].length = static_cast<double>(length);
        if (!(length > 0)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            exact[vertex].normal[axis] = static_cast<double>(sums[vertex][axis] / length);
        }
    }
    return exact;
}

double distance(const Place& p, const Place& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

Surface moved(Surface surface, double scale, const Place& by) {
    for (Place& place : surface.places) {
        for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = scale * place[axis] + by[axis];
    }
    return surface;
}

}  // namespace

TEST_P(VertexNormals, AreAsExactAsTheyPromise) {
    std::mt19937_64 random(11);
    int doubtful = 0, obtuse = 0, all = 0;
    double smooth = 0;  // the largest error where the surface is
    for (const double roughness : {0.0, 0.05, 0.2, 0.5, 1.0}) {
        for (const double scale : {1e-12, 1e-3, 1.0, 1e12}) {
            const Surface surface = moved(rough_torus(40, 30, roughness, random), scale, {0.1 * scale, 0, 0});
            const Found found = normals_of(surface);
            const std::vector<Exact> exact = exact_normals(surface);
            for (std::size_t v = 0; v < exact.size(); ++v) {
                ++all;
                obtuse += exact[v].largest > 104 * std::numbers::pi / 180 ? 1 : 0;
                if (found.is_doubtful[v]) {
                    ++doubtful;
                    EXPECT_EQ(found.normals[v], Place{}) << v;
                    EXPECT_TRUE(exact[v].length < 0.126 || exact[v].largest > 178.7 * std::numbers::pi / 180) << v;
                    continue;
                }
                const double error = distance(found.normals[v], exact[v].normal);
                EXPECT_LT(error, unit_roundoff * (4 + exact[v].error / exact[v].length))
                    << v << ", roughness " << roughness;
                if (roughness <= 0.2) smooth = std::max(smooth, error);
            }
        }
    }
    EXPECT_LT(smooth, 10 * unit_roundoff);
    EXPECT_GT(obtuse, all / 20);
    EXPECT_LT(doubtful, all / 200);
}

TEST_P(VertexNormals, KeepTheirDigitsFarFromTheOrigin) {
    std::mt19937_64 random(12);
    const Surface here = rough_torus(20, 10, 0.1, random);
    const Surface far = moved(here, 1, {1e4, -2e4, 3e4});
    const Found found = normals_of(far);
    const std::vector<Exact> exact = exact_normals(far);
    for (std::size_t v = 0; v < exact.size(); ++v) {
        EXPECT_LT(distance(found.normals[v], exact[v].normal), unit_roundoff * (4 + exact[v].error / exact[v].length));
    }
}

TEST_P(VertexNormals, DoNotDependOnHowBatchesAreCalled) {
    std::mt19937_64 random(13);
    const Surface surface = rough_torus(50, 30, 0.3, random);
    const Found at_once = normals_of(surface);
    for (const int together : {1, 3, 64}) EXPECT_EQ(normals_of(surface, together).normals, at_once.normals);
}

// A vertex that is not finite is felt by its neighbours, and by no other lane.
TEST_P(VertexNormals, WhatIsNotFiniteStaysInItsLane) {
    std::mt19937_64 random(14);
    const Surface whole = rough_torus(40, 30, 0.1, random);
    const Found expected = normals_of(whole);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(), 1e300}) {
        for (const std::size_t axis : {0U, 1U, 2U}) {
            Surface surface = whole;
            const std::size_t vertex = random() % surface.places.size();
            surface.places[vertex][axis] = bad;
            std::vector<bool> is_near(surface.places.size(), false);
            for (const Triangle& t : surface.triangles) {
                if (std::ranges::find(t, static_cast<std::int32_t>(vertex)) == t.end()) continue;
                for (const std::int32_t corner : t) is_near[static_cast<std::size_t>(corner)] = true;
            }
            const Found found = normals_of(surface);
            for (std::size_t v = 0; v < surface.places.size(); ++v) {
                if (is_near[v]) {
                    EXPECT_TRUE(found.is_doubtful[v]) << v;
                    EXPECT_EQ(found.normals[v], Place{}) << v;
                } else {
                    EXPECT_EQ(found.normals[v], expected.normals[v]) << v;
                    EXPECT_EQ(found.is_doubtful[v], expected.is_doubtful[v]) << v;
                }
            }
        }
    }
}

TEST_P(VertexNormals, TrianglesWithoutAnAreaCountForNothing) {
    // Around a square, between its two sides: an edge without a length, and a needle of one edge twice.
    const Surface plain{.places = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        .triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}};
    Surface with = plain;
    with.places.push_back({0, 1, 0});
    with.places.push_back({0, 0, 0});
    with.places.push_back({0, 0.5, 0});
    with.triangles = {{0, 1, 2}, {0, 4, 3}, {0, 3, 1}, {0, 2, 4}, {0, 5, 2}, {0, 6, 2}, {1, 6, 0}, {6, 6, 0}};
    const Found expected = normals_of(plain), found = normals_of(with);
    Surface one_more = plain;
    one_more.places.push_back({0, 0.5, 0});
    one_more.triangles.push_back({1, 4, 0});
    const Found with_one_more = normals_of(one_more);
    EXPECT_FALSE(found.is_doubtful[0]);
    EXPECT_LT(distance(found.normals[0], with_one_more.normals[0]), 8 * unit_roundoff);
    const double third = 1 / std::sqrt(3);
    EXPECT_LT(distance(expected.normals[0], {third, third, third}), 4 * unit_roundoff);
    // Where there is nothing else, the lane says so.
    const Found none = normals_of(
        {.places = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {1, 0, 0}}, .triangles = {{0, 1, 2}, {0, 1, 3}, {1, 1, 2}}});
    for (std::size_t v = 0; v < 4; ++v) {
        EXPECT_TRUE(none.is_doubtful[v]) << v;
        EXPECT_EQ(none.normals[v], Place{}) << v;
    }
}

TEST_P(VertexNormals, FindEveryAngleUpToFlatOnes) {
    for (double degrees = 0.5; degrees < 180; degrees += 0.25) {
        const double angle = degrees * std::numbers::pi / 180;
        // Its weight shows against a triangle at right angles to it.
        Surface surface = fan({angle});
        surface.places.push_back({0, 0, 1});
        surface.triangles.push_back({0, 3, 1});
        const Found found = normals_of(surface);
        if (degrees > 178.8) {
            EXPECT_TRUE(found.is_doubtful[0]) << degrees;
            continue;
        }
        const double length = std::hypot(angle, std::numbers::pi / 2);
        const Place expected{0, std::numbers::pi / 2 / length, angle / length};
        const double lost = degrees > 104 ? 8 / std::sin(angle) : 8;
        EXPECT_FALSE(found.is_doubtful[0]) << degrees;
        EXPECT_LT(distance(found.normals[0], expected), unit_roundoff * lost) << degrees;
    }
}

TEST_P(VertexNormals, GoThroughManyTrianglesAndGaps) {
    // 200 triangles, then a gap, and one more sheet on the same vertex.
    std::vector<double> angles(200, 2 * std::numbers::pi / 201);
    Surface surface = fan(angles);
    const auto first = static_cast<std::int32_t>(surface.places.size());
    surface.places.push_back({1, 0, 0});
    surface.places.push_back({0, 0, 1});
    surface.triangles.push_back({first, first + 1, 0});
    const Found found = normals_of(surface);
    const std::vector<Exact> exact = exact_normals(surface);
    for (std::size_t v = 0; v < surface.places.size(); ++v) {
        EXPECT_FALSE(found.is_doubtful[v]) << v;
        EXPECT_LT(distance(found.normals[v], exact[v].normal), unit_roundoff * (4 + exact[v].error / exact[v].length));
    }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, VertexNormals, ::testing::ValuesIn(compiled_instruction_sets()),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

}  // namespace lancet::kernels::test
