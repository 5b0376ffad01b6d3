#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/mesh/io/cursor.hpp"

namespace lancet::mesh::io {

/// What a .vtu file says about the coding of its arrays.
struct VtkCoding {
    bool swap = false;         ///< binary numbers are in the other byte order
    bool wide_header = false;  ///< headers of binary arrays are of 64 bits instead of 32
    bool compressed = false;   ///< binary arrays are compressed with zlib
};

/// Where one array lies in a .vtu file.
struct VtkArray {
    enum class Layout { ascii, base64, raw };

    Layout layout = Layout::ascii;
    /// The part of the file that holds it; for appended arrays the end is not known, and is the end of all of them.
    std::size_t begin = 0;
    std::size_t end = 0;
    std::string type;
    std::string name;
};

/// Reads an array of exactly `count` values. `place` is what failures name, and its file is where the array lies.
std::vector<double> read_vtk_reals(const VtkArray& array, const VtkCoding& coding, std::size_t count,
                                   const Cursor& place);
/// The same for integers; real numbers are refused.
std::vector<std::int64_t> read_vtk_integers(const VtkArray& array, const VtkCoding& coding, std::size_t count,
                                            const Cursor& place);

}  // namespace lancet::mesh::io
