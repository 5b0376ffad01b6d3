#pragma once

#include <memory>

#include "lancet/runtime/collide/broad_phase.hpp"

namespace lancet::runtime {

std::unique_ptr<BroadPhase> make_aabb_tree();
std::unique_ptr<BroadPhase> make_sphere_tree();
std::unique_ptr<BroadPhase> make_spatial_hash();
std::unique_ptr<BroadPhase> make_octree();
std::unique_ptr<BroadPhase> make_brute_force();

}  // namespace lancet::runtime
