#include "lancet/runtime/cut/enrichment.hpp"

#include <cstddef>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

namespace {

void validate(std::span<const CopyLevel> levels, std::span<const mesh::Point> values) {
    if (levels.size() + 1 != values.size()) {
        throw Error("enrichment: " + std::to_string(values.size()) + " values and " + std::to_string(levels.size()) +
                    " levels; expected one level less than values");
    }
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const CopyLevel& level = levels[k];
        if (level.parent < 0 || static_cast<std::size_t>(level.parent) > k || (level.side != 1 && level.side != -1)) {
            throw Error("enrichment: copy " + std::to_string(k + 1) + " comes from copy " +
                        std::to_string(level.parent) + " on side " + std::to_string(level.side) +
                        "; expected an earlier copy and side 1 or -1");
        }
    }
}

/// (x of the parent, x of the copy) become (u, a).
void split(Enrichment enrichment, double side, double& parent, double& copy) {
    const double jump = side * (parent - copy);
    if (enrichment == Enrichment::shifted) {
        copy = jump;
    } else {
        parent = (parent + copy) / 2;
        copy = jump / 2;
    }
}

/// (u, a) become (x of the parent, x of the copy).
void join(Enrichment enrichment, double side, double& parent, double& copy) {
    const double a = side * copy;
    copy = parent - a;
    if (enrichment == Enrichment::heaviside) parent += a;
}

}  // namespace

std::string_view to_string(Enrichment enrichment) noexcept {
    switch (enrichment) {
        case Enrichment::substituted:
            return "substituted";
        case Enrichment::shifted:
            return "shifted";
        case Enrichment::heaviside:
            break;
    }
    return "heaviside";
}

Enrichment enrichment_from_string(std::string_view name) {
    for (const Enrichment enrichment : {Enrichment::substituted, Enrichment::shifted, Enrichment::heaviside}) {
        if (to_string(enrichment) == name) return enrichment;
    }
    throw Error("unknown enrichment '" + std::string(name) + "'; expected substituted, shifted or heaviside");
}

void copies_to_enriched(Enrichment enrichment, std::span<const CopyLevel> levels, std::span<mesh::Point> values) {
    validate(levels, values);
    if (enrichment == Enrichment::substituted) return;
    for (std::size_t k = levels.size(); k-- > 0;) {
        mesh::Point& parent = values[static_cast<std::size_t>(levels[k].parent)];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            split(enrichment, levels[k].side, parent[axis], values[k + 1][axis]);
        }
    }
}

void enriched_to_copies(Enrichment enrichment, std::span<const CopyLevel> levels, std::span<mesh::Point> values) {
    validate(levels, values);
    if (enrichment == Enrichment::substituted) return;
    for (std::size_t k = 0; k < levels.size(); ++k) {
        mesh::Point& parent = values[static_cast<std::size_t>(levels[k].parent)];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            join(enrichment, levels[k].side, parent[axis], values[k + 1][axis]);
        }
    }
}

}  // namespace lancet::runtime
