#include "lancet/runtime/simulate/changed_layout.hpp"

#include <algorithm>

namespace lancet::runtime {

template <class Real>
ChangedLayout<Real>::ChangedLayout(const BodyChange& change, kernels::NodeNumbering& numbering,
                                   kernels::SpareNodes& spare_nodes, ElasticElements<Real>& elements,
                                   std::span<double> rest_position)
    : change_(&change),
      numbering_(&numbering),
      spare_nodes_(&spare_nodes),
      elements_(&elements),
      rest_position_(rest_position) {}

template <class Real>
std::int32_t ChangedLayout<Real>::number_of(std::int32_t node) const {
    return node < change_->first_node ? numbering_->internal_of_user[node]
                                      : numbers_[static_cast<std::size_t>(node - change_->first_node)];
}

template <class Real>
bool ChangedLayout<Real>::take(std::size_t place, std::span<const std::int32_t> neighbours) {
    const BodyChange::Node& node = change_->nodes[place];
    const auto user = change_->first_node + static_cast<std::int32_t>(place);
    numbers_[place] = spare_nodes_->take(*numbering_, user, node.is_fixed, neighbours);
    if (numbers_[place] < 0) return false;
    std::copy_n(node.rest.begin(), 3, &rest_position_[4 * static_cast<std::size_t>(numbers_[place])]);
    return true;
}

template <class Real>
bool ChangedLayout<Real>::number_nodes() {
    numbers_.reserve(change_->nodes.size());
    for (const BodyChange::Node& node : change_->nodes) {
        numbers_.push_back(node.before < 0 ? -1 : numbering_->internal_of_user[node.before]);
    }
    if (!number_along_elements()) return false;
    // A copy may have no element yet.
    for (std::size_t place = 0; place < numbers_.size(); ++place) {
        if (numbers_[place] < 0 && !take(place, {})) return false;
    }
    return true;
}

template <class Real>
bool ChangedLayout<Real>::number_along_elements() {
    // From what is in the room already and then from element to element, so that what hangs together comes together:
    // each node that begins anew takes an aggregate of its own.
    const std::span<const BodyChange::Element> elements = change_->elements;
    const auto is_new = [&](std::int32_t node) { return number_of(node) < 0; };
    const auto place_of = [&](std::int32_t node) { return static_cast<std::size_t>(node - change_->first_node); };
    std::vector<std::vector<std::size_t>> elements_at(numbers_.size());
    std::vector<std::size_t> beside_room, others;
    for (std::size_t e = 0; e < elements.size(); ++e) {
        if (!elements[e].is_there || std::ranges::none_of(elements[e].nodes, is_new)) continue;
        for (const std::int32_t node : elements[e].nodes) {
            if (is_new(node)) elements_at[place_of(node)].push_back(e);
        }
        const bool is_beside = std::ranges::any_of(elements[e].nodes, [&](std::int32_t node) {
            const std::int32_t number = number_of(node);
            return number >= numbering_->spare_begin && numbering_->is_free(number);
        });
        (is_beside ? beside_room : others).push_back(e);
    }
    std::vector<std::size_t> next;
    const auto number_from = [&](std::size_t first) {
        next.assign(1, first);
        for (std::size_t at = 0; at < next.size(); ++at) {
            const BodyChange::Element& element = elements[next[at]];
            kernels::Tetrahedron known{};
            for (std::size_t k = 0; k < 4; ++k) known[k] = number_of(element.nodes[k]);
            for (std::size_t k = 0; k < 4; ++k) {
                if (known[k] >= 0) continue;
                const std::size_t place = place_of(element.nodes[k]);
                if (!take(place, known)) return false;
                known[k] = numbers_[place];
                next.insert(next.end(), elements_at[place].begin(), elements_at[place].end());
            }
        }
        return true;
    };
    return std::ranges::all_of(beside_room, number_from) && std::ranges::all_of(others, number_from);
}

template <class Real>
std::int32_t& ChangedLayout<Real>::slot_of(const BodyChange::Element& element) {
    std::vector<std::int32_t>& slots = elements_->slot_of_element();
    const auto number = static_cast<std::size_t>(element.element);
    if (number >= slots.size()) slots.resize(number + 1, -1);
    return slots[number];
}

template <class Real>
bool ChangedLayout<Real>::lay_out_elements(LayoutChange& layout) {
    for (const BodyChange::Element& element : change_->elements) {
        std::int32_t& slot = slot_of(element);
        kernels::ElementMove move;
        if (slot >= 0) move.before = nodes_of_slot(elements_->batches(), slot);
        if (slot < 0) ++more_elements_;
        if (!element.is_there) {
            --more_elements_;
            move.slot = slot;
            if (!elements_->change(slot, nullptr, -1)) return false;
            slot = -1;
            layout.moves.push_back(move);
            continue;
        }
        kernels::ChangedElement laid_out{.nodes = {},
                                         .geometry = {},
                                         .material = element.material,
                                         .fraction = element.fraction,
                                         .pair_masses = element.pair_masses};
        std::array<Point, 4> corners{};
        for (std::size_t k = 0; k < 4; ++k) {
            laid_out.nodes[k] = number_of(element.nodes[k]);
            std::copy_n(&rest_position_[4 * static_cast<std::size_t>(laid_out.nodes[k])], 3, corners[k].begin());
        }
        laid_out.geometry = kernels::tetrahedron_geometry(corners, {0, 1, 2, 3});
        const std::int32_t like = element.like < 0 ? -1 : elements_->slot_of_element()[element.like];
        if (!elements_->change(slot, &laid_out, like)) return false;
        move.slot = slot;
        move.after = laid_out.nodes;
        layout.moves.push_back(move);
    }
    elements_->finish_changes(rest_position_.data());
    return true;
}

template class ChangedLayout<float>;
template class ChangedLayout<double>;

}  // namespace lancet::runtime
