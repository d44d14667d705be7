// SPDX-License-Identifier: AGPL-3.0-or-later
// Triangles and solids as arrays.
#include <cmath>
#include <memory>
#include <optional>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "brep/boolean/boolean.h"
#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/solid.h"
#include "convert/surface/isosurface.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/python/arrays.h"
#include "planner/python/module.h"
#include "planner/python/waiting.h"
#include "voxel/space/error.h"
#include "voxel/space/scene.h"

namespace octotomy::planner::python {
namespace {

using brep::Solid;
using brep::Triangles;
using SharedTriangles = std::shared_ptr<Triangles>;

/// Up to this distance, doubles distinguish points that are a ten-millionth of a millimetre apart.
constexpr double farthest_mm = 1e9;

SharedTriangles triangles_of_arrays(const Numbers& vertices_mm, const Numbers& faces) {
  auto triangles = std::make_shared<Triangles>();
  triangles->points_mm = points_3d_of(vertices_mm, "vertices_mm");
  if (faces.ndim() != 2 || faces.shape(1) != 3)
    throw voxel::InvalidInput("triangles must be an array of the shape (n, 3)");
  const auto count = static_cast<double>(triangles->points_mm.size());
  triangles->faces.resize(static_cast<std::size_t>(faces.shape(0)));
  for (py::ssize_t i = 0; i < faces.shape(0); ++i)
    for (py::ssize_t corner = 0; corner < 3; ++corner) {
      const double point = faces.at(i, corner);
      if (point != std::trunc(point))
        throw voxel::InvalidInput("triangle " + std::to_string(i) + " refers to vertex " + plain(point) +
                                  ": give whole numbers");
      if (!(point >= 0.0 && point < count))
        throw voxel::InvalidInput("triangle " + std::to_string(i) + " refers to vertex " + plain(point) +
                                  ", and there are " + plain(count));
      triangles->faces[static_cast<std::size_t>(i)][static_cast<std::size_t>(corner)] =
          static_cast<std::uint32_t>(point);
    }
  return triangles;
}

py::array shown_points(const Triangles& triangles, const py::object& owner) {
  return shown(triangles.points_mm.empty() ? nullptr : &triangles.points_mm.front().x,
               {static_cast<py::ssize_t>(triangles.points_mm.size()), 3}, owner);
}

py::array shown_faces(const Triangles& triangles, const py::object& owner) {
  return shown(triangles.faces.empty() ? nullptr : triangles.faces.front().data(),
               {static_cast<py::ssize_t>(triangles.faces.size()), 3}, owner);
}

SharedTriangles isosurface(const voxel::Scene& scan, double low, double high) {
  return without_lock([&](const std::stop_token& stop) {
    return std::make_shared<Triangles>(convert::isosurface(scan, low, high, {stop, {}}));
  });
}

Solid moved(const Solid& solid, const Numbers& moved_from_still) {
  const glm::dmat4 motion = matrix_of(moved_from_still, "moved_from_still");
  for (int axis = 0; axis < 3; ++axis)
    number_from(motion[3][axis], -farthest_mm, farthest_mm, "the translation of moved_from_still, in mm,");
  return brep::moved(solid, motion);
}

Solid combined(const Solid& a, brep::Operation operation, const Solid& b) {
  return without_lock(
      [&](const std::stop_token& stop) { return brep::boolean(a, operation, b, stop).solid; });
}

void write(const Triangles& triangles, const std::filesystem::path& path) {
  without_lock([&](const std::stop_token&) { brep::write_mesh(brep::mesh_of(triangles), path); });
}

}  // namespace

void add_meshes(py::module_& module) {
  py::class_<Triangles, SharedTriangles> mesh(
      module, "Mesh", "Arbitrary triangles in LPS millimetres, which need not be closed.",
      py::dynamic_attr());
  mesh.attr("audit") = py::tuple();  // for meshes that were not read from a file
  mesh.def(
          py::init(&triangles_of_arrays), py::arg("vertices_mm"), py::arg("triangles"),
          "Copies vertices (n, 3) and the numbers of each triangle's vertices (m, 3), counter-clockwise seen "
          "from outside.")
      .def_property_readonly(
          "vertices_mm",
          [](const py::object& self) { return shown_points(self.cast<const Triangles&>(), self); },
          "The vertices (n, 3), float64; not a copy, not writable.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) { return shown_faces(self.cast<const Triangles&>(), self); },
          "Numbers of vertices (m, 3), uint32; not a copy, not writable.")
      .def(
          "health",
          [](const Triangles& triangles) {
            return python_of(
                to_json(without_lock([&](const std::stop_token&) { return brep::health(triangles); })));
          },
          "Whether the mesh is closed, manifold, oriented and free of self-intersection, with findings.")
      .def(
          "solid",
          [](const Triangles& triangles) {
            return without_lock([&](const std::stop_token&) { return brep::solid_of(triangles); });
          },
          "The solid that the mesh bounds. Raises GeometryError with the first defect and its place.")
      .def("write", &write, py::arg("path"),
           "Writes .stl, .ply, .obj, .off, .vtp or .glb, by the name's extension.");

  py::class_<Solid>(module, "Solid",
                    "The inside of a closed surface, immutable. & (and), | (or), - (less) are mesh Booleans.")
      .def_property_readonly(
          "vertices_mm",
          [](const py::object& self) { return shown_points(self.cast<const Solid&>().triangles(), self); },
          "The vertices (n, 3), float64; not a copy, not writable.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) { return shown_faces(self.cast<const Solid&>().triangles(), self); },
          "Numbers of vertices (m, 3), uint32; not a copy, not writable.")
      .def_property_readonly("volume_mm3", [](const Solid& solid) { return solid.size().volume_mm3; })
      .def_property_readonly("area_mm2", [](const Solid& solid) { return solid.size().area_mm2; })
      .def("__bool__", [](const Solid& solid) { return !solid.empty(); })
      .def("__and__",
           [](const Solid& a, const Solid& b) { return combined(a, brep::Operation::Intersection, b); })
      .def("__or__", [](const Solid& a, const Solid& b) { return combined(a, brep::Operation::Union, b); })
      .def("__sub__",
           [](const Solid& a, const Solid& b) { return combined(a, brep::Operation::Difference, b); })
      .def("moved", &moved, py::arg("moved_from_still"),
           "The solid under a rigid motion of LPS mm; its translation has at most 1e9 mm along each axis.")
      .def(
          "measures",
          [](const Solid& solid) {
            return python_of(to_json(
                without_lock([&](const std::stop_token&) { return brep::Measures(solid.measures()); })));
          },
          "Volume, area, centroid, extents and inertia.")
      .def(
          "write",
          [](const Solid& solid, const std::filesystem::path& path) { write(solid.triangles(), path); },
          py::arg("path"), "Writes .stl, .ply, .obj, .off, .vtp or .glb, by the name's extension.");

  module.def(
      "read_mesh",
      [](const std::filesystem::path& path, const std::optional<std::string>& frame,
         const std::optional<std::string>& unit) {
        brep::MeshFile file = without_lock([&](const std::stop_token&) {
          return brep::read_mesh(path, {frame, unit});
        });
        py::object read = py::cast(std::make_shared<Triangles>(std::move(file.triangles)));
        read.attr("audit") = python_of(to_json(file.audit));
        return read;
      },
      py::arg("path"), py::arg("frame") = py::none(), py::arg("unit") = py::none(),
      "Reads .stl, .ply, .obj, .off, .vtk, .vtp, .vtu, .glb or .3mf. The mesh's `audit` contains the frame "
      "and unit that the file states, and what was assumed; `frame` (\"RAS\") and `unit` (\"inch\") override "
      "these.");
  module.def("isosurface", &isosurface, py::arg("scan"), py::arg("low"), py::arg("high") = 32767.0,
             "The surface on which a scan's samples enter low..high.");
}

}  // namespace octotomy::planner::python
