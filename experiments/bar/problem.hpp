#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace CLI {
class App;
}

namespace lancet::experiments::bar {

/// What the user asked for. The defaults are the Bar: 40 x 8 x 8 cells of 0.1 m, five tetrahedra each, clamped at
/// x = 0, hanging under gravity along -y (Jerabkova 2007). SI units.
struct ProblemOptions {
    std::array<int, 3> cells{40, 8, 8};
    std::array<double, 3> size{4.0, 0.8, 0.8};  ///< m
    int split = 5;                              ///< tetrahedra per cell: 5 (alternating) or 6
    std::string mesh;                           ///< file to read instead of generating the box; empty: the box
    double mesh_scale = 1.0;                    ///< factor on the coordinates of the file, to get metres
    std::string fix = "auto";                   ///< see fixed_nodes(); "auto" on the box: its face x = 0
    double young_modulus = 1e5;                 ///< Pa
    double poisson_ratio = 0.33;
    double density = 100.0;                        ///< kg/m^3
    std::array<double, 2> rayleigh{0.0, 0.0};      ///< D = rayleigh[0] M + rayleigh[1] K; 1/s and s
    std::array<double, 3> gravity{0, -9.81, 0.0};  ///< m/s^2
    double time_step = 0.04;                       ///< s
    int steps = 125;
};

/// The problem that all programs of this experiment solve. SI units; nodes and elements in the user's numbering.
struct Problem {
    mesh::TetMesh mesh;
    double young_modulus = 0;
    double poisson_ratio = 0;
    double density = 0;
    double rayleigh_mass = 0;       ///< 1/s
    double rayleigh_stiffness = 0;  ///< s
    std::array<double, 3> gravity{};
    std::vector<std::int32_t> fixed_nodes;  ///< ascending, at least one, not all
    double time_step = 0;
    int steps = 0;
    double length = 0;               ///< largest extent of the bounding box at rest: errors are in percent of it
    std::vector<std::string> notes;  ///< what the reader of the mesh found and did
};

/// Adds the options of the problem to a program. `options` must outlive the parse; it holds the defaults.
void add_problem_options(CLI::App& app, ProblemOptions& options);

/// The command line that gives `options` again, bit for bit: how a program hands its problem to its workers.
[[nodiscard]] std::vector<std::string> problem_arguments(const ProblemOptions& options);

/// Checks `options`, and generates or reads the mesh. Throws lancet::Error for values without a physical meaning, for a
/// mesh that cannot be read and for an empty or complete set of fixed nodes.
[[nodiscard]] Problem make_problem(const ProblemOptions& options);

/// The nodes that `fix` names, ascending: a box "xmin,ymin,zmin,xmax,ymax,zmax" (closed), the name of a node set of the
/// mesh, or "auto": those in the lowest 5 % of the longest axis. Throws lancet::Error when these are none or all, or
/// when there is no such set.
[[nodiscard]] std::vector<std::int32_t> fixed_nodes(const mesh::TetMesh& mesh, const std::string& fix);

}  // namespace lancet::experiments::bar
