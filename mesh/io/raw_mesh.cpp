#include "lancet/mesh/io/raw_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/repair.hpp"

namespace lancet::mesh::io {

ReadResult finish(RawMesh raw, const std::string& name, const ReadOptions& options) {
    if (!(options.scale > 0) || !std::isfinite(options.scale)) {
        throw Error(name + ": scale " + std::to_string(options.scale) + "; expected a positive finite number");
    }
    if (raw.definition.tetrahedra.empty()) throw Error(name + ": the file holds no tetrahedra");
    if (options.scale != 1) {
        for (Point& x : raw.definition.nodes) {
            for (double& value : x) value *= options.scale;
        }
    }
    if (options.repair) {
        Repaired repaired = repair(std::move(raw.definition),
                                   {.drop_flat = options.drop_flat, .drop_duplicates = options.drop_duplicates});
        raw.definition = std::move(repaired.definition);
        raw.notes.insert(raw.notes.end(), repaired.notes.begin(), repaired.notes.end());
    }
    try {
        return {TetMesh(std::move(raw.definition)), std::move(raw.notes)};
    } catch (const Error& error) {
        throw Error(name + ": " + error.what());
    }
}

void OtherCells::report(const std::string& file, std::vector<std::string>& notes) const {
    std::string volumes;
    std::string skipped;
    const auto add_to_lists = [&](const auto& counts) {
        for (const auto& [kind, count] : counts) {
            std::string& list = kind.first == 3 ? volumes : skipped;
            if (!list.empty()) list += ", ";
            list += std::to_string(count) + ' ';
            list += kind.second;
        }
    };
    add_to_lists(count_);
    add_to_lists(named_);
    if (!volumes.empty()) {
        throw Error(file + ": " + volumes + ": the only volume cells read are linear (4-node) tetrahedra");
    }
    if (!skipped.empty()) notes.push_back("skipped cells of lower dimension: " + skipped);
}

void NumberMap::build(const std::vector<std::int64_t>& numbers, const Cursor& cursor, const char* what) {
    dense_.clear();
    sorted_.clear();
    if (numbers.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        cursor.fail(std::string("more ") + what + "s than 32-bit numbers count");
    }
    if (numbers.empty()) return;
    const auto twice = [&](std::int64_t number) {
        cursor.fail(std::string(what) + " number " + std::to_string(number) + " occurs twice");
    };
    const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
    lowest_ = *low;
    const std::uint64_t range = static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
    if (range < 4 * static_cast<std::uint64_t>(numbers.size()) + 1024) {
        dense_.assign(range + 1, -1);
        for (std::size_t n = 0; n < numbers.size(); ++n) {
            std::int32_t& place = dense_[static_cast<std::size_t>(numbers[n] - lowest_)];
            if (place >= 0) twice(numbers[n]);
            place = static_cast<std::int32_t>(n);
        }
        return;
    }
    sorted_.reserve(numbers.size());
    for (const std::int64_t number : numbers) sorted_.emplace_back(number, static_cast<std::int32_t>(sorted_.size()));
    std::sort(sorted_.begin(), sorted_.end());
    for (std::size_t n = 1; n < sorted_.size(); ++n) {
        if (sorted_[n].first == sorted_[n - 1].first) twice(sorted_[n].first);
    }
}

std::int32_t NumberMap::find(std::int64_t number) const {
    if (!dense_.empty()) {
        const std::uint64_t place = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(lowest_);
        return place < dense_.size() ? dense_[place] : -1;
    }
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), number,
                                        [](const auto& entry, std::int64_t value) { return entry.first < value; });
    return found != sorted_.end() && found->first == number ? found->second : -1;
}

}  // namespace lancet::mesh::io
