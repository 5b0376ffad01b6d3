#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "lancet/kernels/isa/instruction_set.hpp"

namespace lancet::experiments {

class Samples;

/// The instruction sets that are compiled in and that this machine executes; the others stand in the context of the
/// results as not run.
std::vector<kernels::InstructionSet> instruction_sets_to_measure();

/// "float" or "double".
template <class Real>
constexpr const char* scalar_name() {
    return sizeof(Real) == 4 ? "float" : "double";
}

// One function per subject: registers its benchmarks, named subject/what/scalar/instruction set[/setting].

void register_peak();
void register_rotation();
/// Normals of the Bar's surface, named normals/vertices/float/instruction set; beside them those in double that they
/// are compared with.
void register_normals();
/// Strokes of a blade through the Bar, named cut/strokes/mesh: exact geometry in double, without an instruction set.
void register_cut();

/// Forces, assembly, products, vector passes and preconditioners, on the Bar with each of the `cells`. Returns what
/// they are measured on, which counts failures.
std::shared_ptr<Samples> register_solver(const std::vector<std::array<int, 3>>& cells);

}  // namespace lancet::experiments
