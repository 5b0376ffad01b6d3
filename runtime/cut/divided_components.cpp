#include "lancet/runtime/cut/divided_components.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include "lancet/mesh/components.hpp"

namespace lancet::runtime {

namespace {

CopyName copy_at(CopyName name) {
    return is_opening(name) ? opening_from(name) : name;
}

std::int32_t node_at(const mesh::CutMesh& cut, CopyName name) {
    return cut.node_of_copy()[static_cast<std::size_t>(copy_at(name))];
}

/// Calls visit(element, lane) for all lanes at a node.
template <class Visit>
void for_each_lane_at(const mesh::CutMesh& cut, const DividedElements& elements, CopyName name, const Visit& visit) {
    for (const std::int32_t element : cut.star(node_at(cut, name))) {
        elements.for_each_lane(cut, element, [&](const DividedElements::Lane& lane) {
            if (std::ranges::find(lane.copies, name) != lane.copies.end()) visit(element, lane);
        });
    }
}

}  // namespace

/// Fronts that go on from seeds until they meet.
class DividedComponents::Fronts {
  public:
    Fronts(const mesh::CutMesh& cut, const DividedElements& elements) : cut_(cut), elements_(elements) {}

    void add(CopyName seed, std::int32_t component) {
        const auto front = static_cast<std::int32_t>(fronts_.size());
        if (!owner_.try_emplace(seed, front).second) return;
        fronts_.push_back({component, {seed}, {seed}});
        group_.push_back(front);
        ++open_[component];
    }

    /// What has come off: for each front that met nothing any more, all that it has passed.
    std::vector<std::vector<CopyName>> run() {
        std::vector<std::vector<CopyName>> closed;
        bool goes_on = true;
        while (goes_on) {
            goes_on = false;
            for (std::int32_t front = 0; front < static_cast<std::int32_t>(fronts_.size()); ++front) {
                if (group_[front] != front || open_[fronts_[front].component] < 2) continue;
                goes_on = true;
                // A few nodes at a time: fronts that are next to each other meet at once.
                for (int k = 0; k < 8 && group_[front] == front && !fronts_[front].next.empty(); ++k) advance(front);
                if (group_[front] != front || !fronts_[front].next.empty()) continue;
                int& open = open_[fronts_[front].component];
                if (open < 2) continue;  // the last has met all others: nothing has come off
                --open;
                group_[front] = -1;
                closed.push_back(std::move(fronts_[front].passed));
            }
        }
        return closed;
    }

  private:
    struct Front {
        std::int32_t component;
        std::deque<CopyName> next;
        std::vector<CopyName> passed;
    };

    std::int32_t find(std::int32_t front) {
        while (group_[front] != front) front = group_[front] = group_[group_[front]];
        return front;
    }

    void advance(std::int32_t front) {
        const CopyName name = fronts_[front].next.front();
        fronts_[front].next.pop_front();
        for_each_lane_at(cut_, elements_, name, [&](std::int32_t, const DividedElements::Lane& lane) {
            for (const CopyName other : lane.copies) {
                const auto [owner, is_new] = owner_.try_emplace(other, front);
                if (is_new) {
                    fronts_[find(front)].next.push_back(other);
                    fronts_[find(front)].passed.push_back(other);
                } else {
                    unite(find(owner->second), find(front));
                }
            }
        });
    }

    void unite(std::int32_t a, std::int32_t b) {
        if (a == b) return;
        if (fronts_[a].passed.size() < fronts_[b].passed.size()) std::swap(a, b);
        fronts_[a].next.insert(fronts_[a].next.end(), fronts_[b].next.begin(), fronts_[b].next.end());
        fronts_[a].passed.insert(fronts_[a].passed.end(), fronts_[b].passed.begin(), fronts_[b].passed.end());
        fronts_[b].next.clear();
        group_[b] = a;
        --open_[fronts_[a].component];
    }

    const mesh::CutMesh& cut_;
    const DividedElements& elements_;
    std::unordered_map<CopyName, std::int32_t> owner_;  ///< front
    std::vector<Front> fronts_;
    std::vector<std::int32_t> group_;   ///< [front] another of its group, itself for the one that leads; -1: closed
    std::map<std::int32_t, int> open_;  ///< groups of each component that go on
};

DividedComponents::DividedComponents(const mesh::CutMesh& cut, const DividedElements& elements,
                                     std::vector<bool> is_held)
    : is_held_(std::move(is_held)), has_openings_(!elements.opened_from().empty()) {
    const std::size_t copies = cut.node_of_copy().size();
    std::vector<mesh::Tetrahedron> lanes;
    std::vector<double> volumes;
    for (std::int32_t element = 0; element < static_cast<std::int32_t>(cut.mesh().tetrahedra().size()); ++element) {
        const double volume = cut.mesh().volume(element);
        elements.for_each_lane(cut, element, [&](const DividedElements::Lane& lane) {
            mesh::Tetrahedron& nodes = lanes.emplace_back();
            for (std::size_t k = 0; k < 4; ++k) nodes[k] = elements.node_of(cut, lane.copies[k]);
            volumes.push_back(lane.moments.fraction * volume);
        });
    }
    const mesh::Components components = mesh::components(copies + elements.opened_from().size(), lanes);
    components_.resize(static_cast<std::size_t>(components.count));
    label_.assign(components.of_node.begin(), components.of_node.begin() + static_cast<std::ptrdiff_t>(copies));
    label_of_opening_.assign(components.of_node.begin() + static_cast<std::ptrdiff_t>(copies),
                             components.of_node.end());
    for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
        components_[static_cast<std::size_t>(components.of_element[lane])].volume += volumes[lane];
        whole_ += volumes[lane];
    }
    for (std::size_t node = components.of_node.size(); node-- > 0;) {
        const CopyName name =
            node < copies ? static_cast<CopyName>(node) : opening_from(elements.opened_from()[node - copies]);
        Component& component = components_[static_cast<std::size_t>(components.of_node[node])];
        component.first = name;
        if (is_held_[static_cast<std::size_t>(node_at(cut, name))]) ++component.held;
    }
}

/// All that hangs together with some nodes.
DividedComponents::Piece DividedComponents::piece_of(const mesh::CutMesh& cut, const DividedElements& elements,
                                                     std::vector<CopyName> names) const {
    Piece piece{.names = std::move(names)};
    std::unordered_map<CopyName, bool> is_known;
    for (const CopyName name : piece.names) is_known[name] = true;
    for (std::size_t k = 0; k < piece.names.size(); ++k) {
        const CopyName name = piece.names[k];
        for_each_lane_at(cut, elements, name, [&](std::int32_t element, const DividedElements::Lane& lane) {
            if (lane.copies[0] == name) piece.volume += lane.moments.fraction * cut.mesh().volume(element);
            for (const CopyName other : lane.copies) {
                if (is_known.try_emplace(other, true).second) piece.names.push_back(other);
            }
        });
    }
    return piece;
}

void DividedComponents::take_off(const mesh::CutMesh& cut, const Piece& piece) {
    const std::int32_t before = label_[static_cast<std::size_t>(piece.names.front())];
    const auto component = static_cast<std::int32_t>(components_.size());
    Component& off = components_.emplace_back(Component{-1, 0, piece.volume});
    Component& rest = components_[static_cast<std::size_t>(before)];
    rest.volume -= piece.volume;
    for (const CopyName name : piece.names) {
        label_[static_cast<std::size_t>(name)] = component;
        if (off.first < 0 || name < off.first) off.first = name;
        if (!is_held_[static_cast<std::size_t>(node_at(cut, name))]) continue;
        ++off.held;
        --rest.held;
    }
    auto& first = rest.first;
    while (static_cast<std::size_t>(first) < label_.size() && label_[static_cast<std::size_t>(first)] != before)
        ++first;
}

void DividedComponents::update(const mesh::CutMesh& cut, const DividedElements& elements) {
    if (has_openings_ || !elements.opened_from().empty()) {
        *this = DividedComponents(cut, elements, std::move(is_held_));
        return;
    }
    for (std::size_t copy = label_.size(); copy < cut.node_of_copy().size(); ++copy) {
        label_.push_back(label_[static_cast<std::size_t>(cut.parent_of_copy()[copy])]);
        if (is_held_[static_cast<std::size_t>(cut.node_of_copy()[copy])]) {
            ++components_[static_cast<std::size_t>(label_.back())].held;
        }
    }
    Fronts fronts(cut, elements);
    for (const CopyName name : elements.changed_copies()) fronts.add(name, label_[static_cast<std::size_t>(name)]);
    for (std::vector<CopyName>& names : fronts.run()) take_off(cut, piece_of(cut, elements, std::move(names)));
}

std::vector<std::int32_t> DividedComponents::of_nodes() const {
    std::vector<std::int32_t> components = label_;
    components.insert(components.end(), label_of_opening_.begin(), label_of_opening_.end());
    return components;
}

std::vector<Crumb> DividedComponents::crumbs(const mesh::CutMesh& cut, const DividedElements& elements,
                                             double largest) const {
    std::vector<Crumb> crumbs;
    const auto node_of = [&](const Component& component) { return elements.node_of(cut, component.first); };
    for (const Component& component : components_) {
        if (component.held > 0 || component.volume > largest * whole_) continue;
        const Piece piece = piece_of(cut, elements, {component.first});
        Crumb& crumb = crumbs.emplace_back();
        // Components are numbered by their lowest nodes.
        crumb.component = static_cast<std::int32_t>(
            std::ranges::count_if(components_, [&](const Component& c) { return node_of(c) < node_of(component); }));
        crumb.volume = piece.volume;
        for (const CopyName name : piece.names) crumb.nodes.push_back(elements.node_of(cut, name));
        std::ranges::sort(crumb.nodes);
    }
    std::ranges::stable_sort(crumbs, [](const Crumb& a, const Crumb& b) {
        return a.volume != b.volume ? a.volume > b.volume : a.component < b.component;
    });
    return crumbs;
}

}  // namespace lancet::runtime
