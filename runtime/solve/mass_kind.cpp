#include "lancet/runtime/solve/mass_kind.hpp"

#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

std::string_view to_string(MassKind kind) noexcept {
    switch (kind) {
        case MassKind::lumped:
            return "lumped";
        case MassKind::weighted_diagonal:
            return "weighted-diagonal";
        case MassKind::consistent:
            return "consistent";
        case MassKind::fraction:
            break;
    }
    return "fraction";
}

MassKind mass_kind_from_string(std::string_view name) {
    for (const MassKind kind :
         {MassKind::lumped, MassKind::weighted_diagonal, MassKind::consistent, MassKind::fraction}) {
        if (to_string(kind) == name) return kind;
    }
    throw Error("unknown mass '" + std::string(name) + "'; expected lumped, weighted-diagonal, consistent or fraction");
}

}  // namespace lancet::runtime
