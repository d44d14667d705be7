// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/python/module.h"

#include <filesystem>
#include <pybind11/stl/filesystem.h>

#include "voxel/space/helper_file.h"

PYBIND11_MODULE(_kernel, module) {
  namespace python = octotomy::planner::python;
  module.doc() = "Both kernels of Octotomy, for the package octotomy: import that instead.";
  module.attr("__version__") = OCTOTOMY_VERSION;
  module.def("set_helper_folder", &octotomy::voxel::set_helper_folder, pybind11::arg("folder"),
             "The folder of the meshers and codecs that the library starts.");
  python::add_errors(module);
  python::add_scans(module);
  python::add_octrees(module);
  python::add_meshes(module);
  python::add_pictures(module);
  python::add_plans(module);
}
