#include "lancet/experiments/skips/items.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"

namespace lancet::experiments::skips {
namespace {

std::unique_ptr<Runner> one_bar(bool is_quick, bool can_be_cut) {
    return run_world({}, [=](runtime::Simulation& world) {
        world.add_body({.name = "bar", .scene = bar(is_quick), .can_be_cut = can_be_cut});
    });
}

/// Cuts a notch into the swinging bar, one further along it with every unit, and times how the body takes it up; a step
/// follows that is not timed.
class Notches final : public Runner {
  public:
    Notches(bool is_quick, double room)
        : body_(bar(is_quick), runtime::Settings{}, one_thread(), runtime::CutOptions{.room = room}) {}

    double advance() override {
        const double x = 0.53 + 0.11 * notches_++;
        // From the top, a sixth of the height deep, over all of the width.
        const auto notch = mesh::CutSurface::parallelogram({x, 0.67, -0.1}, {0, 0.2, 0}, {0, 0, 1});
        const runtime::CutUpdate update = body_.cut(one_thread(), notch, runtime::Configuration::rest);
        body_.step(one_thread());
        return update.seconds_update;
    }
    std::vector<mesh::Point> positions() override {
        std::vector<mesh::Point> positions(body_.body().nodes());
        body_.body().positions(positions);
        return positions;
    }

  private:
    int notches_ = 0;
    runtime::CuttableBody body_;
};

}  // namespace

std::vector<Item> items_of_cuts(bool is_quick) {
    const std::string bar_name = is_quick ? "Bar, 1,600 elements" : "Bar";
    constexpr int notches = 20;
    return {
        {.name = "no cut: no enrichment",
         .toggle = "BodyDefinition::can_be_cut = false; without: true",
         .scene = bar_name + ", not cut",
         .with = [=] { return one_bar(is_quick, false); },
         .without = [=] { return one_bar(is_quick, true); },
         .compares_bytes = true},
        {.name = "after a cut only what was touched is rebuilt",
         .toggle = "CutOptions::room = 0.1; without: 0",
         .scene = bar_name + ", a notch at a time",
         .unit = "cut",
         .with = [=] { return std::make_unique<Notches>(is_quick, 0.1); },
         .without = [=] { return std::make_unique<Notches>(is_quick, 0); },
         .units = notches,
         .note = "in place and anew sum in another order"},
    };
}

}  // namespace lancet::experiments::skips
