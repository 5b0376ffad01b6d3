#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::cutting {

/// One line of the results. What was not measured is missing.
struct Row {
    std::string scene{};
    std::string variant{};  ///< which of the scene's bodies
    std::string model = "corotational";
    std::string enrichment = "substituted";  ///< the basis that was solved in; see runtime/cut/enrichment.hpp
    std::string matrix{};                    ///< the operator
    std::string scalar{};
    std::optional<std::int64_t> frame{};  ///< the step of a single frame; missing: the whole run
    std::optional<double> time{};         ///< s
    std::int64_t elements = 0;
    std::int64_t nodes = 0;
    std::int64_t cut_elements = 0;  ///< that consist of more than one part
    std::int64_t parts = 0;         ///< of all elements
    std::int64_t added_dofs = 0;    ///< components of the copies that cuts added, with those that are held
    std::optional<double> ms_geometry{}, ms_topology{},
        ms_update{};                  ///< of a frame, or the mean of all cuts of the run
    std::optional<double> ms_step{};  ///< of a frame, or the median of the run's steps; the shortest of all repetitions
    std::optional<double> ms_solve{};    ///< the part of ms_step in preconditioner and conjugate gradients
    std::optional<double> step_ratio{};  ///< ms_step over that of the uncut body
    std::optional<double> step_ratio_of_cut_element{};  ///< what each cut element adds to the step, over an uncut one's
    std::optional<double> cut_lane_ratio{};             ///< (force + product) of a once-cut element over an uncut one's
    std::optional<double> force_ratio{}, product_ratio{}, edge_ratio{};  ///< the same of each, and edges over edges
    std::optional<double> cg_iterations{};                               ///< of a frame, or the mean of a step
    std::optional<double> error_l2{};                                    ///< relative; of a run: at its end
    std::optional<double> error_energy{};                                ///< relative
    std::optional<double> order_l2{}, order_energy{};                    ///< from the level before
    std::optional<std::int64_t> unknowns{};                              ///< free ones, of static problems
    std::optional<double> noise_percent{};  ///< of the time: (largest - smallest) / median of repetitions
    std::string note{};                     ///< such as "noisy"
};

/// Times that differ by more between repetitions are called noisy.
inline constexpr double noisy_percent = 20;
/// "noisy" or nothing.
[[nodiscard]] std::string noise_note(std::optional<double> noise_percent);

/// All columns, for files; the columns with the given keys, in this order, are those that are printed.
[[nodiscard]] Table make_table(std::span<const Row> rows);
[[nodiscard]] Table make_table(std::span<const Row> rows, std::span<const std::string_view> keys);

}  // namespace lancet::experiments::cutting
