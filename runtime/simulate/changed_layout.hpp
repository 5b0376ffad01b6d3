#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/spare_nodes.hpp"
#include "lancet/runtime/simulate/body.hpp"
#include "lancet/runtime/solve/elastic_elements.hpp"
#include "lancet/runtime/solve/layout_change.hpp"

namespace lancet::runtime {

/// Puts the changed nodes and elements of a body into the room of its layout. Where one of the two functions says that
/// there is not enough, the body has to be laid out anew: what was done until then is not taken back.
template <class Real>
class ChangedLayout {
  public:
    /// All must outlive it. `rest_position`: xyz_ in the internal numbering; those of new nodes are set.
    ChangedLayout(const BodyChange& change, kernels::NodeNumbering& numbering, kernels::SpareNodes& spare_nodes,
                  ElasticElements<Real>& elements, std::span<double> rest_position);

    /// Gives new nodes internal numbers. False where there is no room.
    bool number_nodes();
    /// Lays the elements out, after the nodes, and tells what has moved. False where there is no room.
    bool lay_out_elements(LayoutChange& layout);

    /// The internal number of a node of the changed body.
    std::int32_t number_of(std::int32_t node) const;
    /// Those of the change's nodes.
    std::span<const std::int32_t> numbers() const noexcept { return numbers_; }
    /// How many elements there are more than before.
    std::ptrdiff_t more_elements() const noexcept { return more_elements_; }

  private:
    /// Gives numbers to the new nodes of elements.
    bool number_along_elements();
    bool take(std::size_t place, std::span<const std::int32_t> neighbours);
    std::int32_t& slot_of(const BodyChange::Element& element);

    const BodyChange* change_;
    kernels::NodeNumbering* numbering_;
    kernels::SpareNodes* spare_nodes_;
    ElasticElements<Real>* elements_;
    std::span<double> rest_position_;
    std::vector<std::int32_t> numbers_;
    std::ptrdiff_t more_elements_ = 0;
};

}  // namespace lancet::runtime
