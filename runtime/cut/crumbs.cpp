#include "lancet/runtime/cut/crumbs.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::runtime {

namespace {

constexpr std::array treatments{CrumbTreatment::keep, CrumbTreatment::freeze, CrumbTreatment::drop};

}  // namespace

std::string_view to_string(CrumbTreatment treatment) noexcept {
    switch (treatment) {
        case CrumbTreatment::keep:
            return "keep";
        case CrumbTreatment::freeze:
            return "freeze";
        default:
            return "drop";
    }
}

CrumbTreatment crumb_treatment_from_string(std::string_view name) {
    for (const CrumbTreatment treatment : treatments) {
        if (to_string(treatment) == name) return treatment;
    }
    throw Error("crumbs: '" + std::string(name) + "'; expected keep, freeze or drop");
}

std::vector<Crumb> crumbs(const Scene& divided, double largest) {
    const mesh::Components components = mesh::components(divided.mesh);
    const auto count = static_cast<std::size_t>(components.count);
    std::vector<Crumb> all(count);
    std::vector<bool> is_held(count, false);
    const auto hold = [&](std::int32_t node) {
        is_held[static_cast<std::size_t>(components.of_node[static_cast<std::size_t>(node)])] = true;
    };
    for (const std::int32_t node : divided.fixed_nodes) hold(node);
    for (const PrescribedDisplacement& prescribed : divided.prescribed) hold(prescribed.node);
    double whole = 0;
    for (std::size_t e = 0; e < components.of_element.size(); ++e) {
        const double volume = divided.parts.of(e).fraction * divided.mesh.volume(static_cast<std::int32_t>(e));
        all[static_cast<std::size_t>(components.of_element[e])].volume += volume;
        whole += volume;
    }
    for (std::size_t node = 0; node < components.of_node.size(); ++node) {
        all[static_cast<std::size_t>(components.of_node[node])].nodes.push_back(static_cast<std::int32_t>(node));
    }
    std::vector<Crumb> small;
    for (std::size_t c = 0; c < count; ++c) {
        all[c].component = static_cast<std::int32_t>(c);
        if (!is_held[c] && all[c].volume <= largest * whole) small.push_back(std::move(all[c]));
    }
    std::ranges::stable_sort(small, std::ranges::greater{}, &Crumb::volume);
    return small;
}

void take_weight(Scene& divided, std::span<const Crumb> crumbs) {
    if (crumbs.empty()) return;
    const mesh::Components components = mesh::components(divided.mesh);
    std::vector<bool> is_crumb(static_cast<std::size_t>(components.count), false);
    for (const Crumb& crumb : crumbs) is_crumb[static_cast<std::size_t>(crumb.component)] = true;
    if (divided.parts.empty()) divided.parts.place.assign(divided.mesh.tetrahedra().size(), -1);
    const auto weightless = static_cast<std::int32_t>(divided.parts.moments.size());
    divided.parts.moments.push_back(smallest_moments());
    for (std::size_t e = 0; e < components.of_element.size(); ++e) {
        if (is_crumb[static_cast<std::size_t>(components.of_element[e])]) divided.parts.place[e] = weightless;
    }
}

}  // namespace lancet::runtime
