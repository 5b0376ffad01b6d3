#pragma once

#include <span>
#include <string>

#include "lancet/experiments/stability/case.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/runtime/simulate/body.hpp"

/// The criteria, and where their bounds come from.
namespace lancet::experiments::stability {

/// Half a unit in the last place of 1, doubled: the machine epsilon of the elements' scalar.
double epsilon_of(runtime::ScalarMode scalar);

/// A cut is consistent: the parts of each element are not negative and add up to it within 2^-45 (sums over cells of
/// some tens of roundings each, as many cells as eight cuts make), every copy belongs to a part, and the corners of
/// each part are copies of its element's nodes. A fraction may be zero: next to a coordinate that is zero, the next
/// number is 5e-324, and the cube of that is none. Copies must have mass all the same.
void judge_cut(const mesh::CutMesh& cut, Verdict& verdict);
/// The smallest fraction of an element in a part.
double thinnest_part(const mesh::CutMesh& cut);

/// The energy that rounding can put into the elements in one evaluation of their forces: F is a sum of products of
/// coordinate differences, rounded to eps L for edges of length L and eps_double |x| for coordinates x, with gradients
/// 1 / h, h the smallest height. So |dF| <= 8 (eps L + eps_double |x|) / h, and the energy of that strain is at most
/// (2 mu + 3 lambda) |dF|^2 V / 2.
double rounding_energy(const runtime::Scene& scene, runtime::ScalarMode scalar);
/// The force that the same strain puts on a corner of an element, at most: (2 mu + 3 lambda) |dF| V / h.
double rounding_force(const runtime::Scene& scene, runtime::ScalarMode scalar);

/// How much energy a motion from rest may have.
///
/// With E = kinetic + elastic energy and W the work of the loads so far, exact dynamics have E = W.
/// - Implicit Euler takes energy away, and its safeguard holds E <= W up to 64 eps (E_n + E_n+1) a step; both sides are
///   sums in the elements' scalar, so twice that is allowed for measuring them here.
/// - Central differences of theta = h omega / 2 < 1 keep v^2 + omega^2 (1 - theta^2) x^2 of every linear mode. From
///   rest, that is E <= W for the linear model. For others no bound is proven; from any state the energy of a mode can
///   vary by 1 / (1 - theta^2), so E - W <= theta^2 / (1 - theta^2) max W is asked for. Rounding adds up to
///   2 sqrt(rounding energy) to sqrt(E) in each step.
/// Coordinates of the size |x| give gravity's energy an error of eps_double m g |x|.
struct MotionBound {
    bool is_explicit = false;
    double share_of_work = 0;
    double rounding_energy = 0;  ///< of each force evaluation; implicit: of the energy at the start, zero at rest
    double epsilon = 0;
    double gravity_rounding = 0;
};
MotionBound motion_bound(const runtime::Scene& scene, const runtime::Settings& settings);

/// Takes steps and judges: no step lost, positions and velocities finite, energy within the bound. Adds iterations,
/// repeats and the excess of energy.
void judge_motion(runtime::DeformableBody& body, runtime::Scheduler& scheduler, const MotionBound& bound, int steps,
                  Verdict& verdict);

/// The largest distance of a node from where it should be.
double largest_distance(std::span<const mesh::Point> found, std::span<const mesh::Point> expected);
bool is_finite(std::span<const mesh::Point> points);
std::vector<mesh::Point> positions_of(const runtime::DeformableBody& body);

/// A number for a message.
std::string number(double value);

}  // namespace lancet::experiments::stability
