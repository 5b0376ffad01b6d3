#include "lancet/runtime/collide/broad_phase_kinds.hpp"

namespace lancet::runtime {
namespace {

class BruteForce final : public BroadPhase {
  public:
    BroadPhaseKind kind() const noexcept override { return BroadPhaseKind::brute_force; }

  private:
    void build_index() override {}
    bool refit_index() override { return false; }
    void collect(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const override {
        const auto count = static_cast<std::int32_t>(boxes().size());
        for (std::int32_t i = first; i < count; ++i) {
            if (touch(boxes()[static_cast<std::size_t>(i)], box)) found.push_back(i);
        }
    }
    std::size_t index_bytes() const noexcept override { return 0; }
};

}  // namespace

std::unique_ptr<BroadPhase> make_brute_force() {
    return std::make_unique<BruteForce>();
}

}  // namespace lancet::runtime
