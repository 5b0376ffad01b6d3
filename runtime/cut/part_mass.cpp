#include "lancet/runtime/cut/part_mass.hpp"

#include <cstddef>

namespace lancet::runtime {

std::array<double, 4> corner_masses(MassKind kind, const mesh::PartMoments& part) {
    switch (kind) {
        case MassKind::lumped:
        case MassKind::consistent:
            return part.first;
        case MassKind::weighted_diagonal: {
            std::array<double, 4> masses{};
            double trace = 0;
            for (std::size_t i = 0; i < 4; ++i) trace += part.second[i][i];
            if (trace == 0) return masses;
            for (std::size_t i = 0; i < 4; ++i) masses[i] = part.fraction * (part.second[i][i] / trace);
            return masses;
        }
        case MassKind::fraction:
            break;
    }
    const double share = part.fraction / 4;
    return {share, share, share, share};
}

std::array<std::array<double, 4>, 4> corner_mass_matrix(MassKind kind, const mesh::PartMoments& part) {
    if (kind == MassKind::consistent) return part.second;
    const std::array<double, 4> masses = corner_masses(kind, part);
    std::array<std::array<double, 4>, 4> matrix{};
    for (std::size_t i = 0; i < 4; ++i) matrix[i][i] = masses[i];
    return matrix;
}

}  // namespace lancet::runtime
