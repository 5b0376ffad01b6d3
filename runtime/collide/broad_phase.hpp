#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "lancet/runtime/collide/box.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// How touching boxes are found.
enum class BroadPhaseKind {
    aabb_tree,     ///< binary tree of axis-aligned boxes (van den Bergen 1997), refitted while it is good
    sphere_tree,   ///< the same of bounding spheres
    spatial_hash,  ///< cells of a grid, hashed (Teschner et al. 2003, Optimized Spatial Hashing)
    octree,        ///< loose octree (Ulrich 2000), kept while no box leaves its cell
    brute_force    ///< every box against every other: the reference
};

/// All kinds, in the order of the enumeration.
std::span<const BroadPhaseKind> broad_phase_kinds() noexcept;
/// "aabb-tree", "sphere-tree", "spatial-hash", "octree" or "brute-force".
std::string_view to_string(BroadPhaseKind kind) noexcept;
/// The inverse of to_string. Throws lancet::Error, which lists the choices, for another text.
BroadPhaseKind broad_phase_from_string(std::string_view text);

/// Two boxes that touch, by their numbers.
struct BoxPair {
    std::int32_t first;
    std::int32_t second;

    friend bool operator==(const BoxPair&, const BoxPair&) = default;
};

/// Finds the boxes that touch (see box.hpp): exactly those, whatever the kind, in the same order. Boxes that are not
/// valid are there, but touch nothing, until a refit makes them valid.
///
/// Once vectors have grown to what they have to hold, nothing allocates. The results of a call on several threads are
/// those of one thread.
class BroadPhase {
  public:
    virtual ~BroadPhase() = default;

    virtual BroadPhaseKind kind() const noexcept = 0;

    /// Takes up boxes in place of earlier ones; copies them.
    void build(std::span<const Box> boxes);
    /// The same boxes, moved. Throws lancet::Error if there are not as many as before.
    void refit(std::span<const Box> boxes);
    std::size_t size() const noexcept { return boxes_.size(); }

    /// The boxes that touch `box`, ascending; they replace what was in `found`.
    void query(const Box& box, std::vector<std::int32_t>& found) const;
    /// The pairs (box of ours, one of `others`) that touch, by the other and then by ours. They replace what was in
    /// `found`.
    void pairs(Scheduler& scheduler, std::span<const Box> others, std::vector<BoxPair>& found);
    /// The pairs of our boxes that touch, the smaller number first, ascending. They replace what was in `found`.
    void self_pairs(Scheduler& scheduler, std::vector<BoxPair>& found);

    /// How many refits found that building anew was better (always, for the spatial hash).
    std::int64_t rebuilds() const noexcept { return rebuilds_; }
    /// Bytes of all arrays, with those that results are gathered in.
    std::size_t bytes() const noexcept;

  protected:
    /// Valid, or empty_box.
    std::span<const Box> boxes() const noexcept { return boxes_; }

  private:
    virtual void build_index() = 0;
    /// True if it was built anew.
    virtual bool refit_index() = 0;
    /// Appends the boxes from number `first` on that touch `box` (valid or empty_box), in any order, some perhaps
    /// more than once.
    virtual void collect(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const = 0;
    virtual std::size_t index_bytes() const noexcept = 0;

    struct BlockResult {
        std::vector<std::int32_t> numbers;
        std::vector<BoxPair> pairs;
    };
    void collect_sorted(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const;
    template <class Query>
    void gather(Scheduler& scheduler, std::size_t queries, std::vector<BoxPair>& found, const Query& query);

    std::vector<Box> boxes_;
    std::vector<BlockResult> blocks_;
    std::int64_t rebuilds_ = 0;
};

/// A broad phase without boxes.
std::unique_ptr<BroadPhase> make_broad_phase(BroadPhaseKind kind);

}  // namespace lancet::runtime
