#include "lancet/kernels/isa/instruction_set.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::kernels {

namespace {

struct Named {
    InstructionSet instruction_set;
    std::string_view name;
};

constexpr std::array names = {Named{InstructionSet::scalar, "scalar"}, Named{InstructionSet::sse2, "sse2"},
                              Named{InstructionSet::avx2, "avx2"}, Named{InstructionSet::avx512, "avx512"},
                              Named{InstructionSet::neon, "neon"}};

bool is_compiled_in(InstructionSet instruction_set) {
    const std::vector<InstructionSet> compiled = compiled_instruction_sets();
    return std::find(compiled.begin(), compiled.end(), instruction_set) != compiled.end();
}

InstructionSet choose() {
    if (const char* forced = std::getenv("LANCET_ISA"); forced != nullptr && *forced != '\0') {
        try {
            return require(instruction_set_from_string(forced));
        } catch (const Error& error) {
            throw Error("environment variable LANCET_ISA: " + std::string(error.what()));
        }
    }
    InstructionSet best = InstructionSet::scalar;
    for (const InstructionSet candidate : compiled_instruction_sets()) {
        if (is_executable(candidate)) best = candidate;
    }
    return best;
}

}  // namespace

std::string_view to_string(InstructionSet instruction_set) noexcept {
    for (const Named& named : names) {
        if (named.instruction_set == instruction_set) return named.name;
    }
    return "unknown";
}

InstructionSet instruction_set_from_string(std::string_view name) {
    for (const Named& named : names) {
        if (named.name == name) return named.instruction_set;
    }
    throw Error("unknown instruction set '" + std::string(name) + "'; expected scalar, sse2, avx2, avx512 or neon");
}

std::vector<InstructionSet> compiled_instruction_sets() {
    std::vector<InstructionSet> sets{InstructionSet::scalar};
#if defined(LANCET_HAS_SSE2)
    sets.push_back(InstructionSet::sse2);
#endif
#if defined(LANCET_HAS_AVX2)
    sets.push_back(InstructionSet::avx2);
#endif
#if defined(LANCET_HAS_AVX512)
    sets.push_back(InstructionSet::avx512);
#endif
#if defined(LANCET_HAS_NEON)
    sets.push_back(InstructionSet::neon);
#endif
    return sets;
}

bool is_executable(InstructionSet instruction_set) noexcept {
    switch (instruction_set) {
        case InstructionSet::scalar:
            return true;
#if defined(__x86_64__)
        case InstructionSet::sse2:
            return true;
        case InstructionSet::avx2:
            return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
        case InstructionSet::avx512:
            return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                   __builtin_cpu_supports("avx512vl");
#endif
#if defined(__aarch64__)
        case InstructionSet::neon:
            return true;
#endif
        default:
            return false;
    }
}

InstructionSet active_instruction_set() {
    static const InstructionSet active = choose();
    return active;
}

InstructionSet require(InstructionSet instruction_set) {
    const std::string name(to_string(instruction_set));
    if (!is_compiled_in(instruction_set)) {
        std::string available;
        for (const InstructionSet set : compiled_instruction_sets()) (available += ' ') += to_string(set);
        throw Error("instruction set " + name + " is not compiled in; available are" + available);
    }
    if (!is_executable(instruction_set)) throw Error("this processor cannot execute instruction set " + name);
    return instruction_set;
}

}  // namespace lancet::kernels
