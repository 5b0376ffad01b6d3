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
    // Along elements, so that neighbours are known.
    for (const BodyChange::Element& element : change_->elements) {
        if (!element.is_there) continue;
        kernels::Tetrahedron known{};
        for (std::size_t k = 0; k < 4; ++k) known[k] = number_of(element.nodes[k]);
        for (std::size_t k = 0; k < 4; ++k) {
            if (known[k] >= 0) continue;
            const auto place = static_cast<std::size_t>(element.nodes[k] - change_->first_node);
            if (!take(place, known)) return false;
            known[k] = numbers_[place];
        }
    }
    // A copy may have no element yet.
    for (std::size_t place = 0; place < numbers_.size(); ++place) {
        if (numbers_[place] < 0 && !take(place, {})) return false;
    }
    return true;
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
