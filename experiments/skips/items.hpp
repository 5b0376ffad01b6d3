#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lancet/experiments/skips/runner.hpp"

namespace lancet::experiments::skips {

/// Something that is left out where a scene does not need it.
struct Item {
    std::string name;
    std::string toggle;  ///< the switch: how it is had, against how it is not
    std::string scene;
    std::string unit = "step";
    std::function<std::unique_ptr<Runner>()> with{};     ///< the work is skipped
    std::function<std::unique_ptr<Runner>()> without{};  ///< it is done
    int units = 0;                                       ///< that are timed in a repetition; 0: the default
    bool compares_bytes = false;
    std::string note{};
};

/// Something that cannot be switched, or is not there.
struct Remark {
    std::string name;
    std::string what;
};

/// What a body leaves out: fixed nodes, constant operators, rotations, refreshes, iterations.
std::vector<Item> items_of_body(bool is_quick);
/// What a world leaves out: sleeping bodies and islands, collision, frames.
std::vector<Item> items_of_world(bool is_quick);
/// What a body that is not cut leaves out, and what a cut does.
std::vector<Item> items_of_cuts(bool is_quick);

std::vector<Item> all_items(bool is_quick);
std::vector<Remark> remarks();

}  // namespace lancet::experiments::skips
