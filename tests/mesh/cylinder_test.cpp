#include "lancet/mesh/generate/cylinder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/components.hpp"

namespace {

using lancet::Error;
using lancet::mesh::Cylinder;
using lancet::mesh::cylinder;
using lancet::mesh::Point;
using lancet::mesh::TetMesh;
using lancet::mesh::Tetrahedron;

/// Volume over the cube of the root mean square edge, 1 for the regular tetrahedron.
double shape_quality(const TetMesh& mesh, std::int32_t element) {
    const Tetrahedron& t = mesh.tetrahedra()[element];
    double squares = 0;
    for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double edge = mesh.nodes()[t[a]][axis] - mesh.nodes()[t[b]][axis];
                squares += edge * edge / 6;
            }
        }
    }
    return mesh.volume(element) * 6 * std::numbers::sqrt2 / std::pow(squares, 1.5);
}

TEST(Cylinder, VolumeConvergesToTheRoundOne) {
    const double exact = std::numbers::pi * 0.03 * 0.03 * 0.1;
    double last = 1;
    for (const int across : {1, 2, 4, 8}) {
        const TetMesh mesh = cylinder({.length = 0.1, .radius = 0.03, .cells_along = 5, .cells_across = across});
        EXPECT_EQ(mesh.tetrahedra().size(), 18U * 5U * across * across);
        const double error = 1 - mesh.volume() / exact;
        EXPECT_GT(error, 0);
        // Second order: halving the cells divides the error by four.
        if (across > 1) {
            EXPECT_NEAR(last / error, 4, 0.2);
        }
        last = error;
    }
    EXPECT_LT(last, 0.004);
}

TEST(Cylinder, IsConformingAndOnePiece) {
    const TetMesh mesh = cylinder({.cells_along = 4, .cells_across = 3});
    const auto surface = lancet::mesh::boundary(mesh);
    EXPECT_EQ(surface.overused_faces, 0);
    EXPECT_EQ(surface.triangles.size(), 2U * 6U * 9U + 2U * 18U * 4U);
    EXPECT_EQ(lancet::mesh::components(mesh).count, 1);
    for (const auto& triangle : surface.triangles) {
        const bool on_one_side = std::any_of(mesh.node_sets().begin(), mesh.node_sets().end(), [&](const auto& set) {
            return std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t node) {
                return std::binary_search(set.second.begin(), set.second.end(), node);
            });
        });
        EXPECT_TRUE(on_one_side);
    }
}

TEST(Cylinder, HasWellShapedElements) {
    const TetMesh mesh = cylinder({.length = 0.1, .radius = 0.03, .cells_along = 13, .cells_across = 4});
    double worst = 1;
    double sum = 0;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.tetrahedra().size()); ++t) {
        worst = std::min(worst, shape_quality(mesh, t));
        sum += shape_quality(mesh, t);
    }
    EXPECT_GT(worst, 0.4);
    EXPECT_GT(sum / static_cast<double>(mesh.tetrahedra().size()), 0.6);
}

TEST(Cylinder, LiesAlongTheAxisAskedFor) {
    for (int axis = 0; axis < 3; ++axis) {
        const Cylinder rod{
            .length = 2, .radius = 0.5, .cells_along = 4, .cells_across = 2, .axis = axis, .origin = {1, 2, 3}};
        const TetMesh mesh = cylinder(rod);
        const auto [low, high] = mesh.bounds();
        EXPECT_DOUBLE_EQ(low[axis], rod.origin[axis]);
        EXPECT_DOUBLE_EQ(high[axis], rod.origin[axis] + 2);
        for (const std::int32_t node : mesh.node_set("start")) {
            EXPECT_DOUBLE_EQ(mesh.nodes()[node][axis], rod.origin[axis]);
        }
        for (const std::int32_t node : mesh.node_set("side")) {
            double squares = 0;
            for (int other = 0; other < 3; ++other) {
                if (other != axis) squares += std::pow(mesh.nodes()[node][other] - rod.origin[other], 2);
            }
            EXPECT_NEAR(std::sqrt(squares), 0.5, 1e-15);
        }
    }
}

TEST(Cylinder, RefusesWhatItCannotMesh) {
    EXPECT_THROW(cylinder({.length = 0}), Error);
    EXPECT_THROW(cylinder({.radius = -1}), Error);
    EXPECT_THROW(cylinder({.radius = std::numeric_limits<double>::infinity()}), Error);
    EXPECT_THROW(cylinder({.cells_along = 0}), Error);
    EXPECT_THROW(cylinder({.cells_across = 0}), Error);
    EXPECT_THROW(cylinder({.axis = 3}), Error);
    EXPECT_THROW(cylinder({.cells_across = 100000}), Error);
    EXPECT_THROW(cylinder({.cells_along = std::numeric_limits<int>::max(), .cells_across = 1}), Error);
}

}  // namespace
