#include <array>
#include <bit>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/runtime/collide/broad_phase_kinds.hpp"

namespace lancet::runtime {
namespace {

/// A cell of the grid.
using Cell = std::array<std::int32_t, 3>;

struct Cells {
    Cell lower, upper;  ///< both included

    double count() const noexcept {
        double product = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) product *= double{upper[axis] + 1.0} - lower[axis];
        return product;
    }
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (std::int32_t x = lower[0]; x <= upper[0]; ++x) {
            for (std::int32_t y = lower[1]; y <= upper[1]; ++y) {
                for (std::int32_t z = lower[2]; z <= upper[2]; ++z) visit(Cell{x, y, z});
            }
        }
    }
};

/// A box is entered in every cell that it touches, a query looks into every cell that it touches. Entries lie bucket by
/// bucket in one array, made by counting, so that nothing is allocated per cell and the order is that of the boxes.
/// Built over points (boxes without size) and asked with tetrahedra, this is the algorithm of the paper.
///
/// Cells are as long as the median of the boxes' longest sides: the paper found the mean edge best, and the median is
/// not moved by a few boxes of another size. Boxes in more than `most_cells` cells are kept apart and tested with every
/// query; a query in more cells than there are entries tests all boxes.
class SpatialHash final : public BroadPhase {
  public:
    BroadPhaseKind kind() const noexcept override { return BroadPhaseKind::spatial_hash; }

  private:
    static constexpr double most_cells = 64;

    void build_index() override {
        choose_cells();
        cells_of_box_.resize(boxes().size());
        large_.clear();
        std::size_t entries = 0;
        for (std::size_t i = 0; i < boxes().size(); ++i) {
            const Box& box = boxes()[i];
            cells_of_box_[i] = {{0, 0, 0}, {-1, -1, -1}};
            if (!(box.lower[0] <= box.upper[0])) continue;
            const Cells cells = cells_of(box);
            if (cells.count() > most_cells) {
                large_.push_back(static_cast<std::int32_t>(i));
            } else {
                cells_of_box_[i] = cells;
                entries += static_cast<std::size_t>(cells.count());
            }
        }
        // Twice as many buckets as boxes: few of them then hold more than one cell.
        mask_ = static_cast<std::uint32_t>(std::bit_ceil(std::max<std::size_t>(2 * boxes().size(), 2))) - 1;
        bucket_.assign(std::size_t{mask_} + 2, 0);
        for (const Cells& cells : cells_of_box_) {
            cells.for_each([&](const Cell& cell) { ++bucket_[hash(cell) + 1]; });
        }
        for (std::size_t i = 1; i < bucket_.size(); ++i) bucket_[i] += bucket_[i - 1];
        entries_.resize(entries);
        next_.assign(bucket_.begin(), bucket_.end() - 1);
        for (std::size_t i = 0; i < cells_of_box_.size(); ++i) {
            cells_of_box_[i].for_each(
                [&](const Cell& cell) { entries_[next_[hash(cell)]++] = static_cast<std::int32_t>(i); });
        }
    }

    bool refit_index() override {
        build_index();
        return true;
    }

    void choose_cells() {
        sides_.clear();
        Box all = empty_box;
        for (const Box& box : boxes()) {
            if (!(box.lower[0] <= box.upper[0])) continue;
            sides_.push_back(longest_side(box));
            all = unite(all, box);
        }
        origin_ = middle(all);
        double size = 0;
        if (!sides_.empty()) {
            const auto median = sides_.begin() + static_cast<std::ptrdiff_t>(sides_.size() / 2);
            std::ranges::nth_element(sides_, median);
            size = *median;
            // Points: one a cell if they fill their box.
            if (size == 0) size = longest_side(all) / std::cbrt(static_cast<double>(sides_.size()));
        }
        per_metre_ = size > 0 ? std::min(1 / size, 1e200) : 0;
    }

    Cell cell_of(const Point& place) const noexcept {
        // Far away, cells are all the same: a monotonous map, so that boxes that touch still share a cell.
        constexpr double far = 1 << 30;
        Cell cell;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = std::floor((place[axis] - origin_[axis]) * per_metre_);
            cell[axis] = static_cast<std::int32_t>(std::clamp(at, -far, far));
        }
        return cell;
    }
    Cells cells_of(const Box& box) const noexcept { return {cell_of(box.lower), cell_of(box.upper)}; }

    std::size_t hash(const Cell& cell) const noexcept {
        // The primes of the paper, and a shift: the low bits of products with odd numbers are those of the cell alone.
        std::uint32_t bits = static_cast<std::uint32_t>(cell[0]) * 73856093U ^
                             static_cast<std::uint32_t>(cell[1]) * 19349663U ^
                             static_cast<std::uint32_t>(cell[2]) * 83492791U;
        bits ^= bits >> 15;
        return bits & mask_;
    }

    void collect(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const override {
        if (!(box.lower[0] <= box.upper[0])) return;
        const Cells cells = cells_of(box);
        if (cells.count() > most_cells + static_cast<double>(entries_.size())) {
            for (std::size_t i = static_cast<std::size_t>(first); i < boxes().size(); ++i) test(i, box, found);
            return;
        }
        for (const std::int32_t large : large_) {
            if (large >= first) test(static_cast<std::size_t>(large), box, found);
        }
        cells.for_each([&](const Cell& cell) {
            const std::size_t bucket = hash(cell);
            for (std::uint32_t k = bucket_[bucket]; k < bucket_[bucket + 1]; ++k) {
                if (entries_[k] >= first) test(static_cast<std::size_t>(entries_[k]), box, found);
            }
        });
    }

    void test(std::size_t i, const Box& box, std::vector<std::int32_t>& found) const {
        if (touch(boxes()[i], box)) found.push_back(static_cast<std::int32_t>(i));
    }

    std::size_t index_bytes() const noexcept override {
        using kernels::heap_bytes;
        return heap_bytes(cells_of_box_) + heap_bytes(large_) + heap_bytes(bucket_) + heap_bytes(next_) +
               heap_bytes(entries_) + heap_bytes(sides_);
    }

    Point origin_{};
    double per_metre_ = 0;  ///< cells
    std::uint32_t mask_ = 1;
    std::vector<Cells> cells_of_box_;
    std::vector<std::int32_t> large_;
    std::vector<std::uint32_t> bucket_;  ///< first entry of each, and the end
    std::vector<std::uint32_t> next_;
    std::vector<std::int32_t> entries_;  ///< numbers of boxes
    std::vector<double> sides_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_spatial_hash() {
    return std::make_unique<SpatialHash>();
}

}  // namespace lancet::runtime
