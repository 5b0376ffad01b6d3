#include "lancet/experiments/skips/items.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::skips {
namespace {

std::unique_ptr<Runner> one_bar(bool is_quick, bool can_be_cut) {
    return run_world({}, [=](runtime::Simulation& world) {
        world.add_body({.name = "bar", .scene = bar(is_quick), .can_be_cut = can_be_cut});
    });
}

/// Cuts a notch into the bar, one further along it with every unit, and times how the body takes it up; or builds
/// that body from nothing.
class Notches final : public Runner {
  public:
    Notches(bool is_quick, bool is_anew)
        : scene_(bar(is_quick)), is_anew_(is_anew), body_(scene_, runtime::Settings{}, one_thread()) {}

    double advance() override {
        const double x = 0.53 + 0.11 * notches_++;
        // From the top, a sixth of the height deep, over all of the width.
        const auto notch = mesh::CutSurface::parallelogram({x, 0.67, -0.1}, {0, 0.2, 0}, {0, 0, 1});
        const runtime::CutUpdate update = body_.cut(one_thread(), notch, runtime::Configuration::rest);
        if (!is_anew_) return update.seconds_update;
        const double begin = runtime::steady_seconds();
        const runtime::Scene scene = runtime::divided(scene_, body_.mesh());
        const auto body = runtime::make_body(scene, runtime::Settings{}, one_thread());
        return runtime::steady_seconds() - begin;
    }
    std::vector<mesh::Point> positions() override { return {}; }  // both bodies are where the one before the cut was

  private:
    runtime::Scene scene_;
    bool is_anew_;
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
         .toggle = "no switch: CuttableBody::cut; without: make_body",
         .scene = bar_name + ", a notch at a time",
         .unit = "cut",
         .with = [=] { return std::make_unique<Notches>(is_quick, false); },
         .without = [=] { return std::make_unique<Notches>(is_quick, true); },
         .units = notches,
         .note = "a ratio near 1 says that all of the body is built anew"},
    };
}

}  // namespace lancet::experiments::skips
