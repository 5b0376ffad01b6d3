#pragma once

#include <array>
#include <cmath>
#include <ostream>

#include "lancet/mesh/boundary.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::test {

using mesh::Point;
using runtime::ElementModel;

/// shared/reference/beam-cut/convergence.csv, columns 'extrap': energy in J, the middle of the top, the opening of the
/// lips in the middle of the width; about four digits for case 1, three to four for the others.
struct BeamCase {
    const char* name;
    int load;  ///< 1: gravity; 2, 3: tractions 2T, 3T
    ElementModel model;
    double energy, top_x, top_z, lip;
    double digits;
};

inline void PrintTo(const BeamCase& beam, std::ostream* stream) {
    *stream << beam.name;
}

inline const std::array beam_cases{
    BeamCase{"case1_linear", 1, ElementModel::linear, 0.081196249, 0.11492654, 0.0017825133, 0.0060509805, 2e-4},
    BeamCase{"case1_corotational", 1, ElementModel::corotational, 0.063019124, 0.09399372, -0.026865744, 0.0040345737,
             2e-4},
    BeamCase{"case1_svk", 1, ElementModel::st_venant_kirchhoff, 0.063175117, 0.094101713, -0.027312785, 0.0039641131,
             2e-4},
    BeamCase{"case2T_linear", 2, ElementModel::linear, 0.37611089, 0.20027695, 0.014265813, 0.02435135, 1e-3},
    BeamCase{"case2T_corotational", 2, ElementModel::corotational, 0.099737659, 0.011655419, 0.0075486473, 0.0053715471,
             1e-3},
    BeamCase{"case2T_svk", 2, ElementModel::st_venant_kirchhoff, 0.090833058, 0.0117064, 0.0070504487, 0.0050323654,
             1e-3},
    BeamCase{"case3T_linear", 3, ElementModel::linear, 0.066121349, 0.073548309, 0.0023561915, 0.0080103805, 1e-3},
    BeamCase{"case3T_corotational", 3, ElementModel::corotational, 0.049926525, 0.052969691, -0.01179905, 0.0057714733,
             1e-3},
    BeamCase{"case3T_svk", 3, ElementModel::st_venant_kirchhoff, 0.050251952, 0.052808145, -0.012042214, 0.0056808588,
             1e-3}};

inline bool is_near(double a, double b) {
    return std::abs(a - b) < 1e-9;
}

/// A total force, uniform over the strip of the top face between two x.
inline runtime::Traction pull(const mesh::TetMesh& mesh, double from, double to, const Point& force) {
    const double area = 0.0075 * 0.06;
    const mesh::Boundary boundary = mesh::boundary(mesh);
    return {runtime::triangles_where(
                mesh, boundary.triangles,
                [&](const Point& p) { return is_near(p[2], 0.2) && p[0] > from - 1e-9 && p[0] < to + 1e-9; }),
            {force[0] / area, force[1] / area, force[2] / area}};
}

/// What holds and pulls the beam of 0.03 x 0.06 x 0.2 m in a case, on a mesh of it without cuts or with.
inline runtime::Scene loaded_beam(const BeamCase& beam, mesh::TetMesh mesh) {
    runtime::Scene scene;
    scene.mesh = std::move(mesh);
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        if (scene.mesh.nodes()[node][2] == 0) scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
    }
    scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    scene.gravity = {beam.load == 1 ? 9.81 : 0, 0, 0};
    if (beam.load == 2) scene.tractions.push_back(pull(scene.mesh, 0, 0.0075, {0, 0, 20}));
    if (beam.load == 3) {
        scene.tractions.push_back(pull(scene.mesh, 0, 0.0075, {0, 0, 10}));
        scene.tractions.push_back(pull(scene.mesh, 0.0225, 0.03, {-1, 0, -10}));
    }
    return scene;
}

}  // namespace lancet::test
