#include "lancet/experiments/skips/items.hpp"

namespace lancet::experiments::skips {

std::vector<Item> all_items(bool is_quick) {
    std::vector<Item> all = items_of_cuts(is_quick);
    for (auto* items : {items_of_body, items_of_world}) {
        for (Item& item : items(is_quick)) all.push_back(std::move(item));
    }
    return all;
}

std::vector<Remark> remarks() {
    return {
        {"conjugate gradients start from the last solution",
         "no switch: the unknown is the change of velocity, from zero, and so the start is the last velocity; nothing "
         "of an older solve is kept"},
    };
}

}  // namespace lancet::experiments::skips
