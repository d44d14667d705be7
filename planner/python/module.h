// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

// Each function adds the part of the module octotomy._kernel that its source file has.
namespace octotomy::planner::python {

void add_errors(pybind11::module_& module);
void add_scans(pybind11::module_& module);
void add_octrees(pybind11::module_& module);
void add_meshes(pybind11::module_& module);
void add_pictures(pybind11::module_& module);
void add_plans(pybind11::module_& module);

}  // namespace octotomy::planner::python
