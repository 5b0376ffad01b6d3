#include "lancet/mesh/cut/plane_pool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lancet::mesh {

namespace {

/// The relative precision of the coordinates of points. Sums of a few products lose some units; this is far above them,
/// and far below what volumes and sides notice.
constexpr double precise = 0x1p-44;

}  // namespace

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
    const auto same = std::ranges::find_if(planes_, [&](const StoredPlane& known) {
        return trace.source != nullptr && known.source == trace.source && known.corners == trace.corners &&
               known.is_kept == trace.is_kept;
    });
    if (same != planes_.end()) return static_cast<int>(same - planes_.begin());
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

int PlanePool::find_or_add_point(const std::array<int, 3>& planes) {
    const auto same = std::ranges::find_if(
        points_, [&](const StoredPoint& point) { return std::ranges::is_permutation(point.planes, planes); });
    return same != points_.end() ? static_cast<int>(same - points_.begin()) : add_point(planes);
}

int PlanePool::add_point(const std::array<int, 3>& planes) {
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
        // Products of tiny values may all lie below the range of double; only their ratios matter.
        int largest = std::numeric_limits<int>::min();
        for (const Exact& weight : exact) {
            if (weight.sign() != 0) largest = std::max(largest, weight.exponent());
        }
        for (std::size_t k = 0; k < 4; ++k) point.weights[k] = exact[k].scaled(-largest).bounded();
    }
    double sum = 0;
    for (const Bounded& weight : point.weights) sum += weight.value;
    for (std::size_t k = 0; k < 4; ++k) point.coordinates[k] = point.weights[k].value / sum;
    points_.push_back(point);
    return static_cast<int>(points_.size()) - 1;
}

double PlanePool::volume_fraction(const std::array<int, 4>& points) const {
    // |det c| of the barycentric coordinates c_k. As these add up to one, a column may be replaced by ones, and with
    // the row of a base point subtracted det c = +-det (c_k,i - c_b,i). The base and the column left out are those of
    // the largest coordinate: the other coordinates of the base are then small, zero in a corner, and the differences
    // of small numbers keep their relative precision.
    std::array<const Barycentric*, 4> c{};
    for (std::size_t k = 0; k < 4; ++k) c[k] = &coordinates(points[k]);
    std::size_t base = 0, left_out = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t i = 0; i < 4; ++i) {
            if ((*c[k])[i] > (*c[base])[left_out]) base = k, left_out = i;
        }
    }
    const auto coordinate = [&](std::size_t k, std::size_t i) {
        const double value = (*c[k % 4])[i];
        // A quotient of two such numbers; below the normal ones it has lost its digits.
        const bool is_normal = value == 0 || std::abs(value) >= std::numeric_limits<double>::min();
        return Bounded{value, 4 * precise * std::abs(value) + (is_normal ? 0 : std::numeric_limits<double>::min())};
    };
    std::array<std::array<Bounded, 3>, 3> d{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            const std::size_t i = (left_out + 1 + column) % 4;
            d[row][column] = coordinate(base + 1 + row, i) - coordinate(base, i);
        }
    }
    const Bounded volume = dot(d[0], cross(d[1], d[2]));
    // Between planes that nearly coincide differences cancel.
    return volume.is_precise(0x1p-30) ? std::abs(volume.value) : exact_volume_fraction(points);
}

double PlanePool::exact_volume_fraction(const std::array<int, 4>& points) const {
    // Weights w_k are coordinates times their sums s_k: |det c| = |det w| / (s_0 s_1 s_2 s_3). Powers of two move
    // between both, so that neither leaves the range of double.
    const auto weights = [&](std::size_t k) -> const std::array<Exact, 4>& {
        return exact_weights(points_[static_cast<std::size_t>(points[k])]);
    };
    Exact determinant = dot(weights(0), cross(weights(1), weights(2), weights(3)));
    double divisor = 1;
    for (std::size_t k = 0; k < 4; ++k) {
        const std::array<Exact, 4>& w = weights(k);
        const Exact sum = (w[0] + w[1]) + (w[2] + w[3]);
        determinant = determinant.scaled(-sum.exponent());
        divisor *= std::abs(sum.scaled(-sum.exponent()).value());
    }
    return std::abs(determinant.value()) / divisor;
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
