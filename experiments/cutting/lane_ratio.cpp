#include "lancet/experiments/cutting/lane_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>

#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/statistics.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::experiments::cutting {
namespace {

/// The elements of a scene with their operator, as a body holds them, a little bent.
template <class Real>
class Parts {
  public:
    Parts(const runtime::Scene& scene, const Arithmetic& arithmetic, double time_step, runtime::Scheduler& scheduler)
        : scheduler_(&scheduler),
          numbering_(runtime::number_scene(scene, mesh::OrderingKind::hilbert, {})),
          elements_(make_elements(scene, arithmetic)),
          operator_(runtime::make_operator(
              arithmetic.matrix, elements_,
              {.tetrahedra = scene.mesh.tetrahedra(),
               .nodal_mass = runtime::nodal_masses(scene, runtime::element_materials(scene), numbering_)})) {
        const auto numbers = 4 * static_cast<std::size_t>(numbering_.node_count);
        position_.assign(numbers, 0.0);
        z_.assign(numbers, Real(0));
        for (std::size_t node = 0; node < numbers / 4; ++node) {
            std::copy_n(scene.mesh.nodes().front().begin(), 3, &position_[4 * node]);
        }
        for (const bool is_bent : {false, true}) {
            for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
                const auto internal = static_cast<std::size_t>(numbering_.internal_of_user[node]);
                Point x = scene.mesh.nodes()[node];
                if (is_bent) x = {x[0] - 0.2 * x[0] * x[1], x[1] + 0.1 * x[0] * x[0], x[2] + 0.1 * x[0] * x[1]};
                std::copy_n(x.begin(), 3, &position_[4 * internal]);
                for (std::size_t axis = 0; axis < 3 && is_bent; ++axis) {
                    z_[4 * internal + axis] = static_cast<Real>(std::sin(7 * x[axis] + 3 * x[(axis + 1) % 3]));
                }
            }
            if (!is_bent) elements_.reset(scheduler, position_.data());
        }
        constexpr int until_rotations_have_converged = 6;
        for (int k = 0; k < until_rotations_have_converged; ++k) force();
        operator_->assemble(scheduler, {.mass = 1, .stiffness = time_step * time_step});
        product();
    }

    void force() {
        elements_.evaluate(*scheduler_, position_.data(), {.rotation = true, .force = true});
        scheduler_->for_each_block(numbering_.blocks(), [&](int block) { elements_.merge_force(block); });
    }
    void product() {
        operator_->product(*scheduler_, z_.data());
        scheduler_->for_each_block(numbering_.blocks(), [&](int block) { operator_->merge(block); });
    }

  private:
    runtime::ElasticElements<Real> make_elements(const runtime::Scene& scene, const Arithmetic& arithmetic) {
        const kernels::KernelSet<Real>& kernels = kernels::kernel_set<Real>(arithmetic.instruction_set);
        return runtime::ElasticElements<Real>(
            kernels,
            runtime::element_batches<Real>(scene, numbering_, kernels::ScatterStrategy::private_copies, kernels.width),
            numbering_, runtime::gradient_layout(arithmetic.matrix), {});
    }

    runtime::Scheduler* scheduler_;
    kernels::NodeNumbering numbering_;
    runtime::ElasticElements<Real> elements_;
    std::unique_ptr<runtime::Operator<Real>> operator_;
    kernels::AlignedVector<double> position_;
    kernels::AlignedVector<Real> z_;
};

/// A plane through the middle of each layer of cells.
mesh::CutMesh cut_every_element(const mesh::TetMesh& bar) {
    std::set<double> layers;
    for (const Point& node : bar.nodes()) layers.insert(node[0]);
    mesh::CutMesh cut(bar);
    for (auto layer = layers.begin(); std::next(layer) != layers.end(); ++layer) {
        cut.cut(mesh::CutSurface::plane({(*layer + *std::next(layer)) / 2, 0, 0}, {1, 0, 0}));
    }
    if (cut.parts().size() != 2 * bar.tetrahedra().size() ||
        count_cut_elements(cut) != static_cast<std::int64_t>(bar.tetrahedra().size())) {
        throw CheckFailed("planes through all layers of cells do not cut every element once");
    }
    return cut;
}

double count_edges(const mesh::TetMesh& mesh) {
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;
    for (const mesh::Tetrahedron& t : mesh.tetrahedra()) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i + 1; j < 4; ++j) edges.emplace_back(std::min(t[i], t[j]), std::max(t[i], t[j]));
        }
    }
    std::ranges::sort(edges);
    return static_cast<double>(std::distance(edges.begin(), std::ranges::unique(edges).begin()));
}

template <class Real>
LaneRatio measure(const runtime::Scene& bar, const Arithmetic& arithmetic, double time_step,
                  runtime::Scheduler& scheduler, int repetitions) {
    const mesh::CutMesh cut = cut_every_element(bar.mesh);
    const runtime::Scene divided = runtime::divided(bar, cut);
    Parts<Real> whole(bar, arithmetic, time_step, scheduler), parts(divided, arithmetic, time_step, scheduler);
    const auto seconds = [](Parts<Real>& subject, void (Parts<Real>::*work)()) {
        constexpr int times = 2;
        const double start = runtime::steady_seconds();
        for (int k = 0; k < times; ++k) (subject.*work)();
        return (runtime::steady_seconds() - start) / times;
    };
    struct Times {
        double force_whole, force_cut, product_whole, product_cut;
        double both() const { return (force_cut + product_cut) / (force_whole + product_whole); }
    };
    Times best{1e300, 1e300, 1e300, 1e300};
    std::vector<double> both;
    for (int k = 0; k < repetitions; ++k) {
        const Times now{seconds(whole, &Parts<Real>::force), seconds(parts, &Parts<Real>::force),
                        seconds(whole, &Parts<Real>::product), seconds(parts, &Parts<Real>::product)};
        both.push_back(now.both());
        for (double Times::*time :
             {&Times::force_whole, &Times::force_cut, &Times::product_whole, &Times::product_cut}) {
            best.*time = std::min(best.*time, now.*time);
        }
    }
    const auto elements = static_cast<double>(bar.mesh.tetrahedra().size());
    return {.force = best.force_cut / best.force_whole,
            .product = best.product_cut / best.product_whole,
            .both = best.both(),
            .lanes = static_cast<double>(cut.parts().size()) / elements,
            .nodes = static_cast<double>(cut.node_of_copy().size()) / static_cast<double>(bar.mesh.nodes().size()),
            .edges = count_edges(divided.mesh) / count_edges(bar.mesh),
            .noise_percent = summarize(both).spread_percent(),
            .force_ns = 1e9 * best.force_whole / elements,
            .product_ns = 1e9 * best.product_whole / elements};
}

}  // namespace

LaneRatio measure_lane_ratio(const runtime::Scene& bar, const Arithmetic& arithmetic, double time_step,
                             runtime::Scheduler& scheduler, int repetitions) {
    return arithmetic.scalar == runtime::ScalarMode::double_precision
               ? measure<double>(bar, arithmetic, time_step, scheduler, repetitions)
               : measure<float>(bar, arithmetic, time_step, scheduler, repetitions);
}

}  // namespace lancet::experiments::cutting
