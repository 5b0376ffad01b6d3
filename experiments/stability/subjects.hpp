#pragma once

#include "lancet/experiments/stability/case.hpp"

namespace lancet::experiments::stability {

Category fractions();       ///< a cube with a cut so near its nodes that a given fraction of an element is cut off
Category critical_steps();  ///< the critical step of a cut element, in every basis and lumping
Category sequences();       ///< random cuts of random bodies, then steps under gravity
Category progressive();     ///< random cuts of random bodies while they move
Category recovery();        ///< bodies that have lost their shape
Category poisson_ratios();  ///< up to 0.4999
Category stiff_parts();     ///< a stiffness ratio of up to 1e6 across a cut body
Category flat_elements();   ///< quality down to 1e-6
Category not_finite();      ///< NaN, infinity and numbers beyond the scalar put into one element

/// The words of details with numbers: "1e-14".
std::string power_of_ten(int exponent);

}  // namespace lancet::experiments::stability
