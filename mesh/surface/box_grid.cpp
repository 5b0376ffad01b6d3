#include "lancet/mesh/surface/box_grid.hpp"

#include <cmath>

namespace lancet::mesh {

BoxGrid::BoxGrid(std::span<const Bounds> boxes) : boxes_(boxes.begin(), boxes.end()) {
    if (boxes.empty()) return;
    bounds_ = boxes[0];
    std::array<double, 3> mean{};
    for (const Bounds& box : boxes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            bounds_[0][axis] = std::min(bounds_[0][axis], box[0][axis]);
            bounds_[1][axis] = std::max(bounds_[1][axis], box[1][axis]);
            mean[axis] += (box[1][axis] - box[0][axis]) / static_cast<double>(boxes.size());
        }
    }
    const auto extent = [&](std::size_t axis) { return bounds_[1][axis] - bounds_[0][axis]; };
    const double longest = std::max({extent(0), extent(1), extent(2)});
    // Cubes as many as boxes, had the body the shape of its box; flat directions count as thick as a box is.
    const double least = std::max({mean[0], mean[1], mean[2], longest * 1e-3});
    double volume = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) volume *= std::max(extent(axis), least);
    const double size = std::max(least, std::cbrt(volume / static_cast<double>(boxes.size())));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        cells_[axis] = size > 0 ? std::max(1, static_cast<int>(std::floor(extent(axis) / size))) : 1;
        cell_[axis] = extent(axis) / cells_[axis];
    }
    const auto for_each_cell = [&](const Bounds& box, const auto& use) {
        const std::array<int, 3> low = cell_of(box[0]), high = cell_of(box[1]);
        for (int k = low[2]; k <= high[2]; ++k) {
            for (int j = low[1]; j <= high[1]; ++j) {
                for (int i = low[0]; i <= high[0]; ++i) use(number({i, j, k}));
            }
        }
    };
    const std::size_t count = number({0, 0, cells_[2]});
    first_.assign(count + 1, 0);
    for (const Bounds& box : boxes) for_each_cell(box, [&](std::size_t cell) { ++first_[cell + 1]; });
    for (std::size_t cell = 0; cell < count; ++cell) first_[cell + 1] += first_[cell];
    entries_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t b = 0; b < boxes.size(); ++b) {
        for_each_cell(boxes[b], [&](std::size_t cell) { entries_[next[cell]++] = static_cast<std::int32_t>(b); });
    }
}

std::array<int, 3> BoxGrid::cell_of(const Point& place) const {
    std::array<int, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(cell_[axis] > 0)) continue;
        const double index = std::floor((place[axis] - bounds_[0][axis]) / cell_[axis]);
        cell[axis] = static_cast<int>(std::clamp(index, 0.0, static_cast<double>(cells_[axis] - 1)));
    }
    return cell;
}

}  // namespace lancet::mesh
