#include "lancet/mesh/io/write_msh.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/atomic_file.hpp"

namespace lancet::mesh {

namespace {

constexpr std::int32_t point_type = 15;
constexpr std::int32_t tetrahedron_type = 4;

class Writer {
  public:
    Writer(const std::filesystem::path& path, const TetMesh& mesh, const MshOptions& options)
        : file_(path), mesh_(mesh), binary_(options.binary), regions_(mesh.regions().begin(), mesh.regions().end()) {
        if (!regions_.empty() && *regions_.begin() < 0) {
            throw Error(path.string() + ": region " + std::to_string(*regions_.begin()) +
                        "; the format numbers physical groups from 1");
        }
        for (const auto& [name, members] : mesh.node_sets()) check_name(path, name);
        for (const auto& [region, name] : mesh.region_names()) check_name(path, name);
        for (const auto& [name, members] : mesh.node_sets()) members_ += members.size();
        if (members_ + mesh.tetrahedra().size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
            throw Error(path.string() + ": more elements and members of node sets than 32-bit numbers count");
        }
    }

    void write(MshVersion version) {
        file_ << "$MeshFormat\n" << (version == MshVersion::v4_1 ? "4.1 " : "2.2 ") << (binary_ ? "1 8\n" : "0 8\n");
        if (binary_) file_.binary(std::int32_t{1}) << "\n";
        file_ << "$EndMeshFormat\n";
        write_names();
        if (version == MshVersion::v4_1) {
            write_entities_4();
            write_nodes_4();
            write_elements_4();
        } else {
            write_nodes_2();
            write_elements_2();
        }
        file_.commit();
    }

  private:
    static void check_name(const std::filesystem::path& path, const std::string& name) {
        if (name.find_first_of("\"\r\n") != std::string::npos) {
            throw Error(path.string() + ": the name '" + name + "' has a quote or a line end");
        }
    }

    /// A number followed by a space, or as it lies in memory.
    template <typename Value>
    void put(Value value) {
        if (binary_) {
            file_.binary(value);
        } else {
            file_.number(value) << " ";
        }
    }
    void put_size(std::size_t value) { put(std::uint64_t{value}); }
    void end_line() {
        if (!binary_) file_ << "\n";
    }

    void write_names() {
        std::size_t count = mesh_.node_sets().size();
        for (const auto& [region, name] : mesh_.region_names()) count += region > 0 ? 1U : 0U;
        if (count == 0) return;
        file_ << "$PhysicalNames\n";
        file_.number(count) << "\n";
        std::int32_t number = 0;
        for (const auto& [name, members] : mesh_.node_sets()) {
            file_ << "0 ";
            file_.number(++number) << " \"" << name << "\"\n";
        }
        for (const auto& [region, name] : mesh_.region_names()) {
            if (region <= 0) continue;
            file_ << "3 ";
            file_.number(region) << " \"" << name << "\"\n";
        }
        file_ << "$EndPhysicalNames\n";
    }

    void write_nodes_2() {
        file_ << "$Nodes\n";
        file_.number(mesh_.nodes().size()) << "\n";
        std::int32_t number = 0;
        for (const Point& x : mesh_.nodes()) {
            put(++number);
            for (const double value : x) put(value);
            end_line();
        }
        file_ << (binary_ ? "\n$EndNodes\n" : "$EndNodes\n");
    }

    void write_element_2(std::int32_t number, std::int32_t type, std::int32_t group,
                         std::span<const std::int32_t> nodes) {
        if (!binary_) {
            put(number);
            put(type);
            put(2);
        }
        if (binary_) put(number);
        put(group);
        put(group == 0 ? 1 : group);
        for (const std::int32_t node : nodes) put(node + 1);
        end_line();
    }

    /// In binary, elements come in blocks with a header of type, count and number of tags.
    void begin_block_2(std::int32_t type, std::size_t count) {
        if (!binary_ || count == 0) return;
        put(type);
        put(static_cast<std::int32_t>(count));
        put(2);
    }

    void write_elements_2() {
        file_ << "$Elements\n";
        file_.number(members_ + mesh_.tetrahedra().size()) << "\n";
        begin_block_2(tetrahedron_type, mesh_.tetrahedra().size());
        std::int32_t number = 0;
        for (std::size_t t = 0; t < mesh_.tetrahedra().size(); ++t) {
            write_element_2(++number, tetrahedron_type, mesh_.regions()[t], mesh_.tetrahedra()[t]);
        }
        std::int32_t group = 0;
        for (const auto& [name, members] : mesh_.node_sets()) {
            ++group;
            begin_block_2(point_type, members.size());
            for (const std::int32_t node : members) write_element_2(++number, point_type, group, std::span(&node, 1));
        }
        file_ << (binary_ ? "\n$EndElements\n" : "$EndElements\n");
    }

    /// A volume for each region, numbered from 1, and a point for each node set.
    void write_entities_4() {
        file_ << "$Entities\n";
        put_size(mesh_.node_sets().size());
        put_size(0);
        put_size(0);
        put_size(regions_.size());
        end_line();
        std::int32_t number = 0;
        for (const auto& [name, members] : mesh_.node_sets()) {
            const Point x = members.empty() ? Point{} : mesh_.nodes()[members.front()];
            put(++number);
            for (const double value : x) put(value);
            put_size(1);
            put(number);
            end_line();
        }
        const auto bounds = mesh_.bounds();
        for (const std::int32_t region : regions_) {
            volumes_[region] = static_cast<std::int32_t>(volumes_.size()) + 1;
            put(volumes_[region]);
            for (const Point& corner : bounds) {
                for (const double value : corner) put(value);
            }
            put_size(region == 0 ? 0 : 1);
            if (region != 0) put(region);
            put_size(0);
            end_line();
        }
        file_ << (binary_ ? "\n$EndEntities\n" : "$EndEntities\n");
    }

    void write_nodes_4() {
        const std::size_t count = mesh_.nodes().size();
        file_ << "$Nodes\n";
        put_size(count == 0 ? 0 : 1);
        put_size(count);
        put_size(count == 0 ? 0 : 1);
        put_size(count);
        end_line();
        if (count > 0) {
            put(3);
            put(1);
            put(0);
            put_size(count);
            end_line();
        }
        for (std::size_t n = 1; n <= count; ++n) {
            put_size(n);
            end_line();
        }
        for (const Point& x : mesh_.nodes()) {
            for (const double value : x) put(value);
            end_line();
        }
        file_ << (binary_ ? "\n$EndNodes\n" : "$EndNodes\n");
    }

    /// The end of the run of elements of one region.
    std::size_t run_end(std::size_t begin) const {
        std::size_t end = begin;
        while (end < mesh_.regions().size() && mesh_.regions()[end] == mesh_.regions()[begin]) ++end;
        return end;
    }

    void begin_block_4(std::int32_t dimension, std::int32_t entity, std::int32_t type, std::size_t count) {
        put(dimension);
        put(entity);
        put(type);
        put_size(count);
        end_line();
    }

    void write_elements_4() {
        const std::size_t elements = mesh_.tetrahedra().size();
        std::size_t blocks = mesh_.node_sets().size();
        for (std::size_t begin = 0; begin < elements; begin = run_end(begin)) ++blocks;
        file_ << "$Elements\n";
        put_size(blocks);
        put_size(elements + members_);
        put_size(elements + members_ == 0 ? 0 : 1);
        put_size(elements + members_);
        end_line();
        std::size_t number = 0;
        // Runs instead of one block for each region keep the order of the elements.
        for (std::size_t begin = 0; begin < elements;) {
            const std::size_t end = run_end(begin);
            begin_block_4(3, volumes_.at(mesh_.regions()[begin]), tetrahedron_type, end - begin);
            for (; begin < end; ++begin) {
                put_size(++number);
                for (const std::int32_t node : mesh_.tetrahedra()[begin]) put_size(static_cast<std::size_t>(node) + 1);
                end_line();
            }
        }
        std::int32_t entity = 0;
        for (const auto& [name, members] : mesh_.node_sets()) {
            begin_block_4(0, ++entity, point_type, members.size());
            for (const std::int32_t node : members) {
                put_size(++number);
                put_size(static_cast<std::size_t>(node) + 1);
                end_line();
            }
        }
        file_ << (binary_ ? "\n$EndElements\n" : "$EndElements\n");
    }

    io::AtomicFile file_;
    const TetMesh& mesh_;
    bool binary_;
    std::set<std::int32_t> regions_;
    std::map<std::int32_t, std::int32_t> volumes_;
    std::size_t members_ = 0;
};

}  // namespace

void write_msh(const std::filesystem::path& path, const TetMesh& mesh, const MshOptions& options) {
    Writer(path, mesh, options).write(options.version);
}

}  // namespace lancet::mesh
