#include "lancet/mesh/cut/plane_pool.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace lancet::mesh {

namespace {

/// The relative precision of the coordinates of points. Sums of a few products lose some units; this is far above them,
/// and far below what volumes and sides notice.
constexpr double precise = 0x1p-44;
/// That of volumes.
constexpr double sufficient = 0x1p-30;

}  // namespace

PlanePool::PlanePool() {
    for (std::size_t corner = 0; corner < 4; ++corner) {
        StoredPlane face;
        face.values[corner] = {1, 0};
        planes_.push_back(face);
    }
}

void PlanePool::set_error(StoredPlane& plane) {
    for (const Bounded& value : plane.values) {
        const double size = std::abs(value.value);
        if (size == 0 && value.error == 0) continue;
        const bool is_ordinary = size > 0x1p-300 && size < 0x1p+300;
        plane.error = std::max(plane.error, is_ordinary ? value.error / size : std::numeric_limits<double>::infinity());
    }
}

int PlanePool::number_of_frame(const std::array<Point, 4>& corners) {
    for (std::size_t frame = frames_.size(); frame > 0; --frame) {
        if (frames_[frame - 1] == corners) return static_cast<int>(frame) - 1;
    }
    frames_.push_back(corners);
    return static_cast<int>(frames_.size()) - 1;
}

void PlanePool::take_vertices(StoredPlane& plane) {
    const std::span<const Point> places = plane.source->vertices();
    for (std::size_t k = 0; k < places.size(); ++k) {
        // The latest first: facets come with their neighbours.
        std::size_t number = vertices_.size();
        while (number > 0 &&
               !(vertices_[number - 1].place == places[k] && vertices_[number - 1].frame == plane.frame)) {
            --number;
        }
        if (number == 0) {
            vertices_.push_back({places[k], plane.frame});
            number = vertices_.size();
        }
        plane.vertices[k] = static_cast<int>(number) - 1;
    }
}

int PlanePool::add_plane(const Plane& source, const std::array<Point, 4>& corners) {
    StoredPlane stored{.source = &source, .frame = number_of_frame(corners), .is_kept = {true, true, true, true}};
    for (std::size_t k = 0; k < 4; ++k) {
        Bounded& value = stored.values[k];
        value = source.value(corners[k]);
        // What follows reads these values often: an uncertain one is better settled here.
        if (!value.is_precise(precise)) value = source.extended(corners[k]).bounded();
        if (!value.is_precise(precise)) value = source.exact(corners[k]).bounded();
        stored.is_precise = stored.is_precise && value.is_precise(precise);
    }
    take_vertices(stored);
    set_error(stored);
    planes_.push_back(stored);
    return planes() - 1;
}

int PlanePool::add_values(const std::array<double, 4>& values) {
    StoredPlane stored;
    for (std::size_t k = 0; k < 4; ++k) stored.values[k] = {values[k], 0};
    set_error(stored);
    planes_.push_back(stored);
    return planes() - 1;
}

std::array<double, 4> PlanePool::values(int number) const {
    const StoredPlane& stored = plane(number);
    return {stored.values[0].value, stored.values[1].value, stored.values[2].value, stored.values[3].value};
}

int PlanePool::add_trace(const PlanePool& other, int plane, const std::array<int, 3>& face) {
    const StoredPlane& original = other.plane(plane);
    StoredPlane trace{.source = original.source, .is_precise = original.is_precise};
    std::array<Point, 4> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(face[k]);
        if (original.frame >= 0) corners[k] = other.frames_[static_cast<std::size_t>(original.frame)][corner];
        trace.is_kept[k] = original.is_kept[corner];
        trace.values[k] = original.values[corner];
    }
    trace.frame = number_of_frame(corners);
    const auto same = std::ranges::find_if(planes_, [&](const StoredPlane& known) {
        return trace.source != nullptr && known.source == trace.source && known.frame == trace.frame &&
               known.is_kept == trace.is_kept;
    });
    if (same != planes_.end()) return static_cast<int>(same - planes_.begin());
    if (trace.source != nullptr) take_vertices(trace);
    set_error(trace);
    planes_.push_back(trace);
    return planes() - 1;
}

const std::array<Extended, 4>& PlanePool::extended_values(int number) const {
    const StoredPlane& stored = plane(number);
    if (stored.extended) return *stored.extended;
    std::array<Extended, 4> values;
    for (std::size_t k = 0; k < 4; ++k) {
        // A value without an error is exact as it stands: that of a face, or a zero.
        if (stored.source == nullptr || stored.values[k].error == 0) {
            values[k] = {stored.values[k].value, 0, 0};
        } else if (stored.is_kept[k]) {
            values[k] = stored.source->extended(frames_[static_cast<std::size_t>(stored.frame)][k]);
        }
    }
    stored.extended = std::make_shared<const std::array<Extended, 4>>(values);
    return *stored.extended;
}

const std::array<Exact, 4>& PlanePool::exact_values(int number) const {
    const StoredPlane& stored = plane(number);
    if (stored.exact) return *stored.exact;
    std::array<Exact, 4> values;
    for (std::size_t k = 0; k < 4; ++k) {
        if (stored.source == nullptr || stored.values[k].error == 0) {
            values[k] = Exact(stored.values[k].value);
        } else if (stored.is_kept[k]) {
            values[k] = stored.source->exact(frames_[static_cast<std::size_t>(stored.frame)][k]);
        }
    }
    stored.exact = std::make_shared<const std::array<Exact, 4>>(std::move(values));
    return *stored.exact;
}

const std::array<Extended, 4>& PlanePool::extended_weights(const StoredPoint& point) const {
    if (point.extended) return *point.extended;
    std::array<Extended, 4> weights =
        cross(extended_values(point.planes[0]), extended_values(point.planes[1]), extended_values(point.planes[2]));
    const Extended sum = (weights[0] + weights[1]) + (weights[2] + weights[3]);
    // A sum without a certain sign leaves that of the weights open.
    if (!sum.is_certain()) {
        for (Extended& weight : weights) weight.error = std::numeric_limits<double>::infinity();
    } else if (sum.sign() < 0) {
        for (Extended& weight : weights) weight = -weight;
    }
    point.extended = std::make_shared<const std::array<Extended, 4>>(weights);
    return *point.extended;
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
    const auto sorted = [](std::array<int, 3> numbers) {
        if (numbers[0] > numbers[1]) std::swap(numbers[0], numbers[1]);
        if (numbers[1] > numbers[2]) std::swap(numbers[1], numbers[2]);
        if (numbers[0] > numbers[1]) std::swap(numbers[0], numbers[1]);
        return numbers;
    };
    const std::array<int, 3> wanted = sorted(planes);
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const std::array<int, 3>& known = points_[k].planes;
        if (known[0] + known[1] + known[2] != wanted[0] + wanted[1] + wanted[2]) continue;
        if (sorted(known) == wanted) return static_cast<int>(k);
    }
    return add_point(planes);
}

/// The weights of a point by one bound for all roundings of each; false where that is not enough.
bool PlanePool::find_weights(StoredPoint& point) const {
    const StoredPlane &p = plane(point.planes[0]), &q = plane(point.planes[1]), &r = plane(point.planes[2]);
    // Six products of three factors each, some of them computed in other ways; a few roundings for each.
    const double error = p.error + q.error + r.error + 0x1p-50;
    if (!(error < precise)) return false;
    std::array<double, 6> minors{}, sizes{};
    constexpr std::array<std::array<std::size_t, 2>, 6> pairs{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
    for (std::size_t m = 0; m < 6; ++m) {
        const auto [i, j] = pairs[m];
        const double first = q.values[i].value * r.values[j].value, second = q.values[j].value * r.values[i].value;
        minors[m] = first - second;
        sizes[m] = std::abs(first) + std::abs(second);
    }
    const auto set = [&](std::size_t k, std::array<std::size_t, 3> from, std::array<std::size_t, 3> of, double sign) {
        const double a = p.values[from[0]].value, b = p.values[from[1]].value, c = p.values[from[2]].value;
        const double size = std::abs(a) * sizes[of[0]] + std::abs(b) * sizes[of[1]] + std::abs(c) * sizes[of[2]];
        point.weights[k] = {sign * (a * minors[of[0]] - b * minors[of[1]] + c * minors[of[2]]), error * size};
        return point.weights[k].is_precise(precise);
    };
    if (!set(0, {1, 2, 3}, {5, 4, 3}, 1) || !set(1, {0, 2, 3}, {5, 2, 1}, -1) || !set(2, {0, 1, 3}, {4, 2, 0}, 1) ||
        !set(3, {0, 1, 2}, {3, 1, 0}, -1)) {
        return false;
    }
    return true;
}

int PlanePool::add_point(const std::array<int, 3>& planes) {
    StoredPoint point{.planes = planes};
    if (!find_weights(point))
        point.weights = cross(plane(planes[0]).values, plane(planes[1]).values, plane(planes[2]).values);
    // The point lies in the tetrahedron: no two weights differ in sign.
    const auto are_precise = [](const auto& weights) {
        return std::ranges::all_of(weights, [](const auto& weight) { return weight.is_precise(precise); });
    };
    if (are_precise(point.weights)) {
        const bool is_negative =
            std::ranges::any_of(point.weights, [](const Bounded& weight) { return weight.sign() < 0; });
        for (Bounded& weight : point.weights) weight = is_negative ? -weight : weight;
    } else if (const std::array<Extended, 4>& extended = extended_weights(point); are_precise(extended)) {
        for (std::size_t k = 0; k < 4; ++k) point.weights[k] = extended[k].bounded();
    } else {
        const std::array<Exact, 4>& exact = exact_weights(point);
        // Products of tiny values may all lie below the range of double; only their ratios matter.
        int largest = std::numeric_limits<int>::min();
        for (const Exact& weight : exact) {
            if (weight.sign() != 0) largest = std::max(largest, weight.exponent());
        }
        for (std::size_t k = 0; k < 4; ++k) point.weights[k] = exact[k].scaled(-largest).bounded();
        point.is_precise = are_precise(point.weights);
    }
    double sum = 0;
    for (const Bounded& weight : point.weights) sum += weight.value;
    for (std::size_t k = 0; k < 4; ++k) point.coordinates[k] = point.weights[k].value / sum;
    points_.push_back(std::move(point));
    return points() - 1;
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
    return volume.is_precise(sufficient) ? std::abs(volume.value) : extended_volume_fraction(points);
}

double PlanePool::extended_volume_fraction(const std::array<int, 4>& points) const {
    // Weights w_k are coordinates times their sums s_k: |det c| = |det w| / (s_0 s_1 s_2 s_3).
    const auto weights = [&](std::size_t k) -> const std::array<Extended, 4>& {
        return extended_weights(points_[static_cast<std::size_t>(points[k])]);
    };
    const Extended determinant = dot(weights(0), cross(weights(1), weights(2), weights(3)));
    Extended divisor{1, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::array<Extended, 4>& w = weights(k);
        divisor = divisor * ((w[0] + w[1]) + (w[2] + w[3]));
    }
    const bool is_known = determinant.is_precise(sufficient / 4) && divisor.is_precise(sufficient / 4);
    return is_known ? std::abs(determinant.high) / divisor.high : exact_volume_fraction(points);
}

double PlanePool::exact_volume_fraction(const std::array<int, 4>& points) const {
    // The same; powers of two move between both, so that neither leaves the range of double.
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
    const StoredPlane& at = plane(plane_number);
    const StoredPoint& point = points_[static_cast<std::size_t>(point_number)];
    double sum = 0, size = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const double term = at.values[k].value * point.weights[k].value;
        sum += term;
        size += std::abs(term);
    }
    // Each term is right to twice the precision of its factors, unless it is below the normal numbers.
    const bool is_certain = at.is_precise && point.is_precise && std::abs(sum) > 4 * precise * size + 0x1p-1000;
    return is_certain ? (sum > 0 ? 1 : -1) : find_side(plane_number, point_number);
}

/// True where the planes that meet in the point have so many vertices in common with another that it goes through the
/// point too: two of them an edge, which is then the line in which they meet, or all three a vertex.
bool PlanePool::meet_in_vertices(const StoredPlane& other, const StoredPoint& point) const {
    std::array<unsigned, 3> shared{};  // bits: which of the other plane's vertices
    for (std::size_t i = 0; i < 3; ++i) {
        const std::array<int, 3>& vertices = plane(point.planes[i]).vertices;
        for (std::size_t k = 0; k < 3; ++k) {
            const int vertex = other.vertices[k];
            const bool is_shared =
                vertex >= 0 && (vertex == vertices[0] || vertex == vertices[1] || vertex == vertices[2]);
            shared[i] |= is_shared ? 1U << k : 0U;
        }
    }
    return (shared[0] & shared[1] & shared[2]) != 0 || std::popcount(shared[0] & shared[1]) >= 2 ||
           std::popcount(shared[1] & shared[2]) >= 2 || std::popcount(shared[2] & shared[0]) >= 2;
}

int PlanePool::find_side(int plane_number, int point_number) const {
    const StoredPoint& point = points_[static_cast<std::size_t>(point_number)];
    for (const int through : point.planes) {
        if (through == plane_number) return 0;
    }
    if (meet_in_vertices(plane(plane_number), point)) return 0;
    const Bounded bounded = dot(plane(plane_number).values, point.weights);
    if (bounded.is_certain()) return bounded.sign();
    const Extended extended = dot(extended_values(plane_number), extended_weights(point));
    if (extended.is_certain()) return extended.sign();
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
