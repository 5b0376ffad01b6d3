#pragma once

#include <string_view>
#include <vector>

namespace lancet::kernels {

/// What kernels can be compiled for; each value has a tag of the same name in simd/instruction_set.hpp.
enum class InstructionSet { scalar, sse2, avx2, avx512, neon };

/// The name that LANCET_ISA and every option use.
std::string_view to_string(InstructionSet instruction_set) noexcept;

/// The inverse of to_string. Throws Error, naming the choices, for an unknown name.
InstructionSet instruction_set_from_string(std::string_view name);

/// What was compiled in, from scalar to the widest.
std::vector<InstructionSet> compiled_instruction_sets();

/// True if this processor and operating system can execute it.
bool is_executable(InstructionSet instruction_set) noexcept;

/// The instruction set that runs when none is asked for: the one that the environment variable LANCET_ISA names, else
/// the widest that is compiled in and executable. Chosen once per process. Throws Error if LANCET_ISA names one that is
/// unknown, not compiled in, or that this machine cannot execute.
InstructionSet active_instruction_set();

/// Returns its argument. Throws Error unless it is compiled in and executable here.
InstructionSet require(InstructionSet instruction_set);

}  // namespace lancet::kernels
