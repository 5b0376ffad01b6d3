#pragma once

#include <cstdint>
#include <vector>

#include "lancet/runtime/simulate/surface.hpp"
#include "lancet/runtime/simulate/tool.hpp"

namespace lancet::runtime {

/// What is to be seen at one time: a copy that belongs to whoever looks at it.
struct Frame {
    std::int64_t number = 0;  ///< from 0, dropped ones counted
    std::int64_t step = 0;    ///< world steps that had been taken
    double time = 0;          ///< s
    double input_stamp = 0;   ///< of the latest tool sample that it shows (see ToolSample); 0 without one
    std::vector<SurfaceShape> bodies;
    std::vector<ToolSample> tools;
};

}  // namespace lancet::runtime
