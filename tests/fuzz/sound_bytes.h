// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

// Sound files that the program reads and does not write.
namespace octotomy::tests {

std::string nifti2();                ///< 6 x 5 x 4 samples of int16
std::string vtk(), vtk_binary();     ///< a tetrahedron
std::string vtp_text(), stl_text();  ///< the same
std::string vtk_grid(), vtu_text();  ///< a cube, as a cell of volume, with a field
std::string obj_polygons();          ///< a prism over an L, as polygons
std::string model_3mf();             ///< two tetrahedra placed by components, as XML
std::string ply_text();              ///< the same
std::string frd();                   ///< CalculiX's result of a tetrahedron about it, with displacements
std::string gzip_bomb();             ///< a gzip member of 64 MiB of zeros

}  // namespace octotomy::tests
