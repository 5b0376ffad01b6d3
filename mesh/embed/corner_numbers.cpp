#include "lancet/mesh/embed/corner_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lancet::mesh {

CornerNumbers::Place CornerNumbers::place_of(const MaterialPoint& point) const {
    const Tetrahedron& copies = cut_.parts()[static_cast<std::size_t>(point.part)];
    std::array<std::pair<std::int32_t, double>, 4> terms{};
    for (std::size_t k = 0; k < 4; ++k) {
        const bool is_zero = std::abs(point.weights[k]) < same_weight;
        terms[k] = is_zero ? std::pair(-1, 0.0) : std::pair(copies[k], point.weights[k]);
    }
    std::sort(terms.begin(), terms.end());
    Place place;
    for (std::size_t k = 0; k < 4; ++k) {
        place.copies[k] = terms[k].first;
        place.weights[k] = terms[k].second;
    }
    return place;
}

std::int32_t CornerNumbers::find(const MaterialPoint& point) const {
    const Place place = place_of(point);
    const auto found = entries_.find(place.copies);
    if (found == entries_.end()) return -1;
    for (const Entry& entry : found->second) {
        double largest = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            largest = std::max(largest, std::abs(entry.weights[k] - place.weights[k]));
        }
        if (largest < same_weight) return entry.number;
    }
    return -1;
}

void CornerNumbers::add(const MaterialPoint& point, std::int32_t number) {
    const Place place = place_of(point);
    entries_[place.copies].push_back({place.weights, number});
}

}  // namespace lancet::mesh
