// Abaqus input files: nodes, linear tetrahedra, sets.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "lancet/mesh/io/raw_mesh.hpp"

namespace lancet::mesh::io {

namespace {

/// Numbers first, first + step, ... up to last, and where the file says so.
struct Range {
    std::int64_t first, last, step;
    std::size_t place;

    std::uint64_t size() const {
        return (static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first)) /
                   static_cast<std::uint64_t>(step) +
               1;
    }
    bool same_numbers(const Range& other) const {
        return first == other.first && last == other.last && step == other.step;
    }
};

struct NumberSet {
    std::string name;  // as first spelled
    std::vector<Range> ranges;
};

struct Element {
    std::int64_t number;
    std::array<std::int64_t, 4> nodes;
    std::int32_t set;  // index of the element set that its keyword line names, -1 for none
    std::size_t place;
};

struct Keyword {
    std::string name;  // lower case, without the star
    std::map<std::string, std::string> options;

    bool has(const std::string& option) const { return options.contains(option); }
    std::string value(const std::string& option) const {
        const auto found = options.find(option);
        return found == options.end() ? std::string() : found->second;
    }
};

std::string_view unquoted(std::string_view word) {
    if (word.size() >= 2 && word.front() == '"' && word.back() == '"') return word.substr(1, word.size() - 2);
    return word;
}

/// The parts of a line between commas, trimmed; nothing for what follows a comma at the end.
std::vector<std::string_view> fields(std::string_view line) {
    std::vector<std::string_view> result;
    line = trimmed(line);
    while (!line.empty()) {
        const std::size_t comma = line.find(',');
        result.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) break;
        line.remove_prefix(comma + 1);
        line = trimmed(line);
    }
    return result;
}

/// Dimension of an element type by the way such names begin; 3 for what is not known, so that it is refused.
int dimension_of(const std::string& type) {
    for (const char* prefix : {"t2d", "t3d", "b21", "b22", "b23", "b31", "b32", "b33", "pipe", "rb", "r2d2", "conn"}) {
        if (type.starts_with(prefix)) return 1;
    }
    for (const char* prefix : {"mass", "spring", "dashpot", "rotaryi", "dcoup"}) {
        if (type.starts_with(prefix)) return 0;
    }
    for (const char* prefix : {"s3", "s4", "s6", "s8", "s9", "stri", "m3d", "cps", "cpe", "cax", "sfm", "r3d", "ds"}) {
        if (type.starts_with(prefix)) return 2;
    }
    return 3;
}

class Reader {
  public:
    explicit Reader(Cursor& cursor) : cursor_(cursor), entries_left_(16 * cursor.remaining() + 16) {}

    RawMesh read() {
        while (cursor_.remaining() > 0) {
            const std::string_view line = trimmed(cursor_.line());
            if (line.empty() || line.starts_with("**")) continue;
            if (line.front() != '*') cursor_.fail("expected a keyword (*NAME), but found " + in_quotes(line));
            const Keyword keyword = read_keyword(line);
            if (keyword.name == "include" || keyword.has("input")) {
                cursor_.fail("*" + keyword.name + " refers to another file, which is not read");
            }
            if (keyword.name == "node") {
                read_nodes(keyword);
            } else if (keyword.name == "element") {
                read_elements(keyword);
            } else if (keyword.name == "nset") {
                read_set(keyword, "nset", node_sets_);
            } else if (keyword.name == "elset") {
                read_set(keyword, "elset", element_sets_);
            } else {
                if (keyword.name == "solid section") sections_.push_back(lower(keyword.value("elset")));
                skip_data();
            }
        }
        return finish();
    }

  private:
    /// A keyword line goes on where it ends with a comma.
    Keyword read_keyword(std::string_view line) {
        Keyword keyword;
        bool first = true;
        for (;;) {
            for (const std::string_view part : fields(line)) {
                if (first) {
                    keyword.name = lower(trimmed(part.substr(1)));
                } else {
                    const std::size_t equals = part.find('=');
                    const std::string option = lower(trimmed(part.substr(0, equals)));
                    keyword.options[option] = equals == std::string_view::npos
                                                  ? std::string()
                                                  : std::string(unquoted(trimmed(part.substr(equals + 1))));
                }
                first = false;
            }
            if (!line.ends_with(',') || cursor_.remaining() == 0) return keyword;
            line = trimmed(cursor_.line());
        }
    }

    /// The next line of data into `data`; false before a keyword and at the end.
    bool next_data(std::string_view& data) {
        while (cursor_.remaining() > 0) {
            const std::string_view rest = cursor_.rest();
            const std::size_t begin = rest.find_first_not_of(" \t");
            if (begin != std::string_view::npos && rest[begin] == '*') {
                if (!rest.substr(begin).starts_with("**")) return false;
                cursor_.line();
                continue;
            }
            data = trimmed(cursor_.line());
            if (!data.empty()) return true;
        }
        return false;
    }

    void skip_data() {
        std::string_view data;
        while (next_data(data)) {
        }
    }

    std::int64_t integer(std::string_view word, const char* what) const {
        std::int64_t value = 0;
        if (!parse(word, value))
            cursor_.fail(std::string("expected ") + what + ", an integer, but found " + in_quotes(word));
        return value;
    }

    void read_nodes(const Keyword& keyword) {
        if (keyword.has("system") && lower(keyword.value("system")) != "r") {
            cursor_.fail("nodes in the coordinate system " + in_quotes(keyword.value("system")) +
                         "; expected R (rectangular)");
        }
        NumberSet* set = keyword.has("nset") ? &find_set(node_sets_, keyword.value("nset")) : nullptr;
        std::string_view data;
        while (next_data(data)) {
            const auto parts = fields(data);
            if (parts.size() < 4)
                cursor_.fail("expected a node number and three coordinates, but found " + in_quotes(data));
            const std::int64_t number = integer(parts[0], "a node number");
            Point& x = nodes_.emplace_back();
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (!parse(parts[axis + 1], x[axis])) {
                    cursor_.fail("expected a coordinate, a finite number, but found " + in_quotes(parts[axis + 1]));
                }
            }
            node_numbers_.push_back(number);
            if (set != nullptr) set->ranges.push_back({number, number, 1, cursor_.position()});
        }
    }

    void read_elements(const Keyword& keyword) {
        const std::string type = lower(keyword.value("type"));
        if (type.empty()) cursor_.fail("*ELEMENT without TYPE");
        const bool tetrahedra = type.starts_with("c3d4") && (type.size() == 4 || type[4] < '0' || type[4] > '9');
        std::int32_t set = -1;
        if (keyword.has("elset")) {
            find_set(element_sets_, keyword.value("elset"));
            const std::string name = lower(keyword.value("elset"));
            const auto known = std::find(element_set_order_.begin(), element_set_order_.end(), name);
            set = static_cast<std::int32_t>(known - element_set_order_.begin());
            if (known == element_set_order_.end()) element_set_order_.push_back(name);
        }
        std::string upper = type;
        for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        std::string_view data;
        while (next_data(data)) {
            if (!tetrahedra) {
                while (data.ends_with(',') && next_data(data)) {
                }
                others_.add(dimension_of(type), in_quotes(upper) + " elements");
                continue;
            }
            const auto parts = fields(data);
            if (parts.size() != 5)
                cursor_.fail("expected an element number and four nodes, but found " + in_quotes(data));
            Element& element = elements_.emplace_back();
            element.number = integer(parts[0], "an element number");
            for (std::size_t n = 0; n < 4; ++n) element.nodes[n] = integer(parts[n + 1], "a node of an element");
            element.set = set;
            element.place = cursor_.position();
        }
    }

    static NumberSet& find_set(std::map<std::string, NumberSet>& sets, const std::string& name) {
        NumberSet& set = sets[lower(name)];
        if (set.name.empty()) set.name = name;
        return set;
    }

    void read_set(const Keyword& keyword, const char* option, std::map<std::string, NumberSet>& sets) {
        const std::string name = keyword.value(option);
        if (name.empty()) cursor_.fail("*" + keyword.name + " without a name");
        NumberSet& set = find_set(sets, name);
        const bool generate = keyword.has("generate");
        std::string_view data;
        while (next_data(data)) {
            const auto parts = fields(data);
            if (generate) {
                if (parts.size() < 2 || parts.size() > 3) {
                    cursor_.fail("expected first, last and step of a set, but found " + in_quotes(data));
                }
                const std::int64_t first = integer(parts[0], "the first number");
                const std::int64_t last = integer(parts[1], "the last number");
                const std::int64_t step = parts.size() == 3 ? integer(parts[2], "the step") : 1;
                if (last < first || step < 1) cursor_.fail("a set that does not count upward: " + in_quotes(data));
                add(set, {first, last, step, cursor_.position()});
                continue;
            }
            for (const std::string_view part : parts) {
                std::int64_t number = 0;
                if (parse(part, number)) {
                    add(set, {number, number, 1, cursor_.position()});
                    continue;
                }
                const auto other = sets.find(lower(unquoted(part)));
                if (other == sets.end())
                    cursor_.fail("set " + in_quotes(name) + " names " + in_quotes(part) + ", which is not known");
                if (&other->second == &set) continue;
                for (const Range& range : other->second.ranges) add(set, range);
            }
        }
    }

    /// Sets that contain each other could grow beyond all bounds.
    void add(NumberSet& set, const Range& range) {
        if (!set.ranges.empty() && set.ranges.back().same_numbers(range)) return;
        spend(1);
        set.ranges.push_back(range);
    }

    void spend(std::uint64_t entries) {
        if (entries > entries_left_) cursor_.fail("the sets hold more entries than a file of this size can mean");
        entries_left_ -= entries;
    }

    [[noreturn]] void fail_at(std::size_t place, const std::string& message) const {
        Cursor there = cursor_;
        // Places are behind the line they mean.
        there.move_to(place == 0 ? 0 : place - 1);
        there.mark();
        there.fail(message);
    }

    RawMesh finish() {
        RawMesh raw;
        cursor_.mark();
        others_.report(cursor_.name(), raw.notes);
        NumberMap nodes;
        nodes.build(node_numbers_, cursor_, "node");
        raw.definition.nodes = std::move(nodes_);
        raw.definition.tetrahedra.reserve(elements_.size());
        std::vector<std::int64_t> element_numbers;
        element_numbers.reserve(elements_.size());
        for (const Element& element : elements_) {
            Tetrahedron& t = raw.definition.tetrahedra.emplace_back();
            for (std::size_t n = 0; n < 4; ++n) {
                t[n] = nodes.find(element.nodes[n]);
                if (t[n] < 0) {
                    fail_at(element.place,
                            "an element names node " + std::to_string(element.nodes[n]) + ", which is not in the file");
                }
            }
            element_numbers.push_back(element.number);
        }
        NumberMap elements;
        elements.build(element_numbers, cursor_, "element");
        for (const auto& [key, set] : node_sets_) {
            auto& members = raw.definition.node_sets[set.name];
            for (const Range& range : set.ranges) {
                if (range.size() > node_numbers_.size()) fail_at(range.place, missing(set, range));
                spend(range.size());
                for (std::uint64_t n = 0; n < range.size(); ++n) {
                    const std::int32_t node = nodes.find(range.first + static_cast<std::int64_t>(n) * range.step);
                    if (node < 0) fail_at(range.place, missing(set, range));
                    members.push_back(node);
                }
            }
        }
        assign_regions(elements, raw.definition);
        return raw;
    }

    static std::string missing(const NumberSet& set, const Range& range) {
        return "node set " + in_quotes(set.name) + " names nodes " + std::to_string(range.first) + " to " +
               std::to_string(range.last) + ", which are not all in the file";
    }

    /// Regions 1, 2, ... are the element sets of the solid sections or, where there are none, of the element lines.
    void assign_regions(const NumberMap& elements, TetMesh::Definition& definition) {
        definition.regions.assign(elements_.size(), 0);
        std::int32_t region = 0;
        for (const std::string& name : sections_.empty() ? element_set_order_ : sections_) {
            ++region;
            const auto set = element_sets_.find(name);
            if (set == element_sets_.end()) continue;
            definition.region_names[region] = set->second.name;
            const auto own = std::find(element_set_order_.begin(), element_set_order_.end(), name);
            const auto own_index = static_cast<std::int32_t>(own - element_set_order_.begin());
            for (std::size_t e = 0; e < elements_.size(); ++e) {
                if (elements_[e].set == own_index) definition.regions[e] = region;
            }
            for (const Range& range : set->second.ranges) assign_range(range, region, elements, definition);
        }
    }

    /// Sets also name elements that are not tetrahedra: those are not looked for.
    void assign_range(const Range& range, std::int32_t region, const NumberMap& elements,
                      TetMesh::Definition& definition) {
        if (range.size() <= elements_.size()) {
            for (std::uint64_t n = 0; n < range.size(); ++n) {
                const std::int32_t found = elements.find(range.first + static_cast<std::int64_t>(n) * range.step);
                if (found >= 0) definition.regions[found] = region;
            }
            return;
        }
        for (std::size_t e = 0; e < elements_.size(); ++e) {
            const std::int64_t number = elements_[e].number;
            if (number < range.first || number > range.last) continue;
            const std::uint64_t away = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(range.first);
            if (away % static_cast<std::uint64_t>(range.step) == 0) definition.regions[e] = region;
        }
    }

    Cursor& cursor_;
    std::vector<Point> nodes_;
    std::vector<std::int64_t> node_numbers_;
    std::vector<Element> elements_;
    OtherCells others_;
    std::map<std::string, NumberSet> node_sets_;
    std::map<std::string, NumberSet> element_sets_;
    std::vector<std::string> element_set_order_;
    std::vector<std::string> sections_;
    std::uint64_t entries_left_;
};

}  // namespace

RawMesh read_abaqus(Cursor& cursor) {
    return Reader(cursor).read();
}

}  // namespace lancet::mesh::io
