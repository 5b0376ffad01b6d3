#include "lancet/experiments/skips/tables.hpp"

namespace lancet::experiments::skips {

Table gain_table(std::span<const Item> items, std::span<const Gain> gains) {
    Table table({{"item", "skipped"},
                 {"switch", "switch"},
                 {"scene", "scene"},
                 {"unit", "a unit"},
                 {"ms_with", "skipped", "ms"},
                 {"ms_without", "done", "ms"},
                 {"time_ratio", "ratio"},
                 {"ratio_lowest", "lowest"},
                 {"ratio_highest", "highest"},
                 {"gain", "gain"},
                 {"error_percent", "error", "% of length", 2},
                 {"proof", "proof"},
                 {"bytes_with", "bytes", "skipped", 3},
                 {"bytes_without", "bytes", "done", 3},
                 {"note", "note", "", 3, false}});
    for (std::size_t k = 0; k < items.size(); ++k) {
        const Item& item = items[k];
        const Gain& gain = gains[k];
        const auto bytes = [&](const std::optional<double>& value) {
            return item.compares_bytes && value ? Cell{*value} : Cell{};
        };
        table.add_row({item.name, item.toggle, item.scene, item.unit, gain.ms_with, gain.ms_without, gain.ratio,
                       gain.lowest, gain.highest,
                       std::string(!gain.is_above_noise() ? "within noise"
                                   : gain.ratio < 1       ? "yes"
                                                          : "slower"),
                       gain.compares_motion ? Cell{gain.error_percent} : Cell{},
                       !gain.compares_motion ? Cell{} : Cell{std::string(gain.same_bits ? "same bits" : "measured")},
                       bytes(gain.bytes_with), bytes(gain.bytes_without), item.note});
    }
    return table;
}

Table remark_table(std::span<const Remark> remarks) {
    Table table({{"item", "not switched"}, {"what", "what there is"}});
    for (const Remark& remark : remarks) table.add_row({remark.name, remark.what});
    return table;
}

}  // namespace lancet::experiments::skips
