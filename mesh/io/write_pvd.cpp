#include "lancet/mesh/io/write_pvd.hpp"

#include <cmath>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/atomic_file.hpp"

namespace lancet::mesh {

void write_pvd(const std::filesystem::path& path, std::span<const PvdFrame> frames) {
    io::AtomicFile file(path);
    file << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
    for (const PvdFrame& frame : frames) {
        if (!std::isfinite(frame.time)) throw Error(path.string() + ": the time of a frame is not finite");
        file << "    <DataSet timestep=\"";
        file.number(frame.time) << "\" file=\"" << io::escaped_xml(frame.file.generic_string()) << "\"/>\n";
    }
    file << "  </Collection>\n</VTKFile>\n";
    file.commit();
}

}  // namespace lancet::mesh
