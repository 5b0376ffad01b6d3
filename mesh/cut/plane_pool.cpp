#include "lancet/mesh/cut/plane_pool.hpp"

#include <algorithm>
#include <cmath>

namespace lancet::mesh {

PlanePool::PlanePool() {
    for (std::size_t corner = 0; corner < 4; ++corner) {
        StoredPlane face;
        face.values[corner] = {1, 0};
        planes_.push_back(face);
    }
}

int PlanePool::add_plane(const Plane& source, const std::array<Point, 4>& corners) {
    StoredPlane stored{.source = &source, .corners = corners, .is_kept = {true, true, true, true}};
    for (std::size_t k = 0; k < 4; ++k) {
        stored.values[k] = source.value(corners[k]);
        // What follows reads these values often: an uncertain one is better settled here.
        if (!stored.values[k].is_certain()) stored.values[k] = source.exact(corners[k]).bounded();
    }
    planes_.push_back(stored);
    return planes() - 1;
}

int PlanePool::add_values(const std::array<double, 4>& values) {
    StoredPlane stored;
    for (std::size_t k = 0; k < 4; ++k) stored.values[k] = {values[k], 0};
    planes_.push_back(stored);
    return planes() - 1;
}

std::array<double, 4> PlanePool::values(int number) const {
    const StoredPlane& stored = plane(number);
    return {stored.values[0].value, stored.values[1].value, stored.values[2].value, stored.values[3].value};
}

int PlanePool::add_trace(const PlanePool& other, int plane, const std::array<int, 3>& face) {
    const StoredPlane& original = other.plane(plane);
    StoredPlane trace{.source = original.source};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(face[k]);
        trace.corners[k] = original.corners[corner];
        trace.is_kept[k] = original.is_kept[corner];
        trace.values[k] = original.values[corner];
    }
    planes_.push_back(trace);
    return planes() - 1;
}

const std::array<Exact, 4>& PlanePool::exact_values(int number) const {
    const StoredPlane& stored = plane(number);
    if (stored.exact) return *stored.exact;
    std::array<Exact, 4> values;
    for (std::size_t k = 0; k < 4; ++k) {
        // A value without an error is exact as it stands: that of a face, or a zero.
        if (stored.source == nullptr || stored.values[k].error == 0) {
            values[k] = Exact(stored.values[k].value);
        } else if (stored.is_kept[k]) {
            values[k] = stored.source->exact(stored.corners[k]);
        }
    }
    stored.exact = std::make_shared<const std::array<Exact, 4>>(std::move(values));
    return *stored.exact;
}

const std::array<Exact, 4>& PlanePool::exact_weights(const StoredPoint& point) const {
    if (point.exact) return *point.exact;
    std::array<Exact, 4> weights =
        cross(exact_values(point.planes[0]), exact_values(point.planes[1]), exact_values(point.planes[2]));
    if (((weights[0] + weights[1]) + (weights[2] + weights[3])).sign() < 0) {
        for (Exact& weight : weights) weight = -weight;
    }
    point.exact = std::make_shared<const std::array<Exact, 4>>(std::move(weights));
    return *point.exact;
}

int PlanePool::add_point(const std::array<int, 3>& planes) {
    // Sums of a few products lose some units; this is far above them, and far below what volumes and sides notice.
    constexpr double precise = 0x1p-44;
    StoredPoint point{.planes = planes};
    point.weights = cross(plane(planes[0]).values, plane(planes[1]).values, plane(planes[2]).values);
    // The point lies in the tetrahedron: no two weights differ in sign.
    int sign = 0;
    bool is_precise = true;
    for (const Bounded& weight : point.weights) {
        is_precise = is_precise && weight.is_precise(precise);
        if (weight.is_certain() && weight.sign() != 0) sign = weight.sign();
    }
    if (is_precise) {
        for (Bounded& weight : point.weights) weight = sign < 0 ? -weight : weight;
    } else {
        const std::array<Exact, 4>& exact = exact_weights(point);
        for (std::size_t k = 0; k < 4; ++k) point.weights[k] = exact[k].bounded();
    }
    double sum = 0;
    for (const Bounded& weight : point.weights) sum += weight.value;
    for (std::size_t k = 0; k < 4; ++k) point.coordinates[k] = point.weights[k].value / sum;
    points_.push_back(point);
    return static_cast<int>(points_.size()) - 1;
}

int PlanePool::side(int plane_number, int point_number) const {
    const auto row = static_cast<std::size_t>(plane_number), column = static_cast<std::size_t>(point_number);
    if (sides_.size() <= row) sides_.resize(planes_.size());
    std::vector<std::int8_t>& known = sides_[row];
    if (known.size() <= column) known.resize(points_.size(), unknown);
    if (known[column] == unknown) known[column] = static_cast<std::int8_t>(find_side(plane_number, point_number));
    return known[column];
}

int PlanePool::find_side(int plane_number, int point_number) const {
    const StoredPoint& point = points_[static_cast<std::size_t>(point_number)];
    for (const int through : point.planes) {
        if (through == plane_number) return 0;
    }
    const Bounded bounded = dot(plane(plane_number).values, point.weights);
    if (bounded.is_certain()) return bounded.sign();
    return dot(exact_values(plane_number), exact_weights(point)).sign();
}

int PlanePool::side_of_corner(int plane_number, int corner) const {
    return plane(plane_number).values[static_cast<std::size_t>(corner)].sign();
}

double PlanePool::value(int number, const Barycentric& place) const {
    double value = 0, largest = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const double corner = plane(number).values[k].value;
        value += corner * place[k];
        largest = std::max(largest, std::abs(corner));
    }
    return largest > 0 ? value / largest : 0;
}

}  // namespace lancet::mesh
