#pragma once

#include <cstdint>

#include "lancet/kernels/isa/instruction_set.hpp"

namespace lancet::kernels::test {

enum class Operation {
    add,
    subtract,
    multiply,
    divide,
    negate,
    fma,
    fnma,
    minimum,
    maximum,
    absolute,
    root,
    select_less,
    select_finite,
    add_assign,
    subtract_assign,
    multiply_assign,
    load_store,
    broadcast
};

enum class Comparison { less, less_equal, greater, greater_equal, equal, less_and_equal, less_or_equal, not_less };

/// The pieces of kernels/simd as out-of-line functions of one instruction set. Arrays hold `width` numbers per pack;
/// [3][width] for vectors in lanes, xyz_ for nodes.
template <class Real>
struct SimdProbe {
    int width;
    void (*apply)(Operation operation, const Real* a, const Real* b, const Real* c, Real* result);
    void (*compare)(Comparison comparison, const Real* a, const Real* b, Real* ones, bool* any, bool* all);
    Real (*sum)(const Real* a);
    Real (*largest)(const Real* a);
    void (*load_nodes)(const Real* nodal, const std::int32_t* index, Real* lanes);
    void (*load_consecutive)(const Real* nodal, Real* lanes);
    void (*store_nodes)(Real* nodal, const std::int32_t* index, const Real* lanes);
    void (*store_consecutive)(Real* nodal, const Real* lanes);
    void (*add_to_nodes)(Real* nodal, const std::int32_t* index, const Real* lanes);
    void (*load_differences)(const double* nodal, const std::int32_t* index, const std::int32_t* origin, Real* lanes);
    void (*row_differences)(const double* rows, const std::int32_t* index, const std::int32_t* origin, Real* lanes);
    void (*store_rows)(double* rows, const std::int32_t* index, const Real* lanes);
};

/// The table of an instruction set that is compiled in and executable.
template <class Real>
const SimdProbe<Real>& simd_probe(InstructionSet instruction_set);

/// Defined by the object of each instruction set.
template <class Isa, class Real>
const SimdProbe<Real>& simd_probe_instance();

}  // namespace lancet::kernels::test
