// SPDX-License-Identifier: AGPL-3.0-or-later
// Octrees, and expressions of them under Python's operators.
#include <limits>
#include <pybind11/operators.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <variant>

#include "planner/operation/measure/result_json.h"
#include "planner/python/arrays.h"
#include "planner/python/module.h"
#include "planner/python/waiting.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/expression.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_file.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::planner::python {
namespace {

using voxel::Expression;
using voxel::Octree;

using Voxels = py::array_t<bool, py::array::c_style | py::array::forcecast>;

Octree of_voxels(const Voxels& voxels, const voxel::Universe& universe) {
  const auto side = static_cast<py::ssize_t>(universe.side());
  if (voxels.ndim() != 3 || voxels.shape(0) > side || voxels.shape(1) > side || voxels.shape(2) > side)
    throw voxel::InvalidInput("voxels must be an array of the shape (z, y, x) that fits the universe");
  const glm::ivec3 dims{voxels.shape(2), voxels.shape(1), voxels.shape(0)};
  const bool* const first = voxels.data();
  return without_lock([&](const std::stop_token&) {
    return voxel::octree_of_slices(universe, [&](int z, voxel::SliceBits& slice) {
      bool any = false;
      for (int y = 0; z < dims.z && y < dims.y; ++y) {
        const bool* const row = first + (static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y) +
                                         static_cast<std::size_t>(y)) *
                                            static_cast<std::size_t>(dims.x);
        for (int x = 0, begin = 0; x <= dims.x; ++x)
          if (x == dims.x || !row[x]) {
            if (begin < x) voxel::set_row(slice, y, begin, x - 1);
            any = any || begin < x;
            begin = x + 1;
          }
      }
      return any;
    });
  });
}

Voxels voxels_of(const Octree& octree) {
  const py::ssize_t side = octree.universe().side();
  Voxels voxels({side, side, side});
  bool* const first = voxels.mutable_data();
  without_lock([&](const std::stop_token&) {
    const auto row_bytes = static_cast<std::size_t>(side);
    std::fill(first, first + row_bytes * row_bytes * row_bytes, false);
    voxel::for_each_slice(octree, [&](int z, const voxel::SliceBits& slice) {
      for (int y = 0; y < slice.side; ++y) {
        bool* const row =
            first + (static_cast<std::size_t>(z) * row_bytes + static_cast<std::size_t>(y)) * row_bytes;
        int begin = 0, last = -1;
        while (voxel::next_run(slice, y, last + 1, begin, last)) std::fill(row + begin, row + last + 1, true);
      }
    });
  });
  return voxels;
}

Octree read_octree(const std::filesystem::path& path) {
  voxel::OctreeFile file = without_lock([&](const std::stop_token&) { return voxel::read_octree(path); });
  if (auto* octree = std::get_if<Octree>(&file.tree)) return std::move(*octree);
  if (const auto* partial = std::get_if<voxel::PartialOctree>(&file.tree)) return partial->inside;
  throw voxel::Error(voxel::ErrorCode::Input,
                     path.string() + ": contains grey samples, not an object: use a scan's window");
}

/// A region of a mask: a view, and polygons in the view's millimetres.
voxel::Region region_of(const std::string& view, const std::vector<Numbers>& polygons_mm) {
  voxel::Region region{voxel::parse_view(view), {}};
  for (const Numbers& polygon : polygons_mm) region.polygons_mm.push_back(points_2d_of(polygon, "a polygon"));
  return region;
}

Expression mask(const std::vector<std::pair<std::string, std::vector<Numbers>>>& regions) {
  voxel::RegionMask mask;
  for (const auto& [view, polygons_mm] : regions) mask.regions.push_back(region_of(view, polygons_mm));
  return {std::move(mask)};
}

py::array motion(const std::optional<Numbers>& translate_mm, double degrees,
                 const std::optional<Numbers>& axis, const std::optional<Numbers>& about_mm) {
  voxel::Motion motion;
  if (translate_mm) motion.translate_mm = vector_of(*translate_mm, "translate_mm");
  motion.degrees = degrees;
  if (axis) motion.axis = vector_of(*axis, "axis");
  if (about_mm) motion.about_mm = vector_of(*about_mm, "about_mm");
  return array_of(voxel::moved_from_still(motion));
}

}  // namespace

void add_octrees(py::module_& module) {
  py::class_<Expression>(module, "Expression",
                         "A Boolean expression of objects: & (and), | (or), - (less), ^ (either), ~ (not). "
                         "Nothing is computed until octree() is called.")
      .def(py::init<Octree>(), py::arg("octree"))
      .def(py::self & py::self)
      .def(py::self | py::self)
      .def(py::self - py::self)
      .def(py::self ^ py::self)
      .def(~py::self)
      .def(
          "octree",
          [](const Expression& expression, const voxel::Universe& universe) {
            return without_lock([&](const std::stop_token&) { return voxel::combine(universe, expression); });
          },
          py::arg("universe"), "The octree of the universe's voxels whose centres the expression contains.");

  py::class_<Octree>(module, "Octree",
                     "A set of voxels of a universe; immutable. Its operators make expressions.")
      .def_static("of_voxels", &of_voxels, py::arg("voxels"), py::arg("universe"),
                  "The octree of the voxels that are true in an array (z, y, x), which begins at the "
                  "universe's first voxel.")
      .def("voxels", &voxels_of, "All voxels as an array of truth values (z, y, x).")
      .def_property_readonly("universe", &Octree::universe)
      .def("__len__", [](const Octree& octree) { return octree.voxel_count(); })
      .def("__bool__", [](const Octree& octree) { return !octree.is_empty(); })
      .def(py::self == py::self)
      .def("__and__", [](const Octree& a, const Expression& b) { return Expression(a) & b; })
      .def("__or__", [](const Octree& a, const Expression& b) { return Expression(a) | b; })
      .def("__sub__", [](const Octree& a, const Expression& b) { return Expression(a) - b; })
      .def("__xor__", [](const Octree& a, const Expression& b) { return Expression(a) ^ b; })
      .def("__invert__", [](const Octree& a) { return ~Expression(a); })
      .def(
          "measures",
          [](const Octree& octree) {
            return python_of(
                to_json(without_lock([&](const std::stop_token&) { return voxel::measure(octree); })));
          },
          "Volume, areas, centroid, extents and inertia, as `octotomy measure` names them.")
      .def(
          "write",
          [](const Octree& octree, const std::filesystem::path& path, const std::string& name) {
            without_lock([&](const std::stop_token&) { voxel::write_octree({octree, name, {}}, path); });
          },
          py::arg("path"), py::arg("name") = "", "Writes an .octree file.");
  py::implicitly_convertible<Octree, Expression>();

  module.def("read_octree", &read_octree, py::arg("path"), "Reads an object's .octree file.");
  module.def(
      "window",
      [](const voxel::GreyOctree& grey, double low, double high) {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        return Expression(voxel::window_of(grey, number_from(low, -infinite, infinite, "low"),
                                           number_from(high, -infinite, infinite, "high")));
      },
      py::arg("grey"), py::arg("low"), py::arg("high") = 32767.0,
      "The samples from low to high, both included.");
  module.def(
      "mask", &mask, py::arg("regions"),
      "The points that project into the polygons of every region: pairs of a view and its polygons in mm.");
  module.def(
      "half_space",
      [](const Numbers& normal, double offset_mm) {
        const glm::dvec3 direction = vector_of(normal, "normal");
        const double length = glm::length(direction);
        if (length == 0.0) throw voxel::InvalidInput("normal must not be zero");
        return Expression(voxel::HalfSpace{direction / length, offset_mm / length});
      },
      py::arg("normal"), py::arg("offset_mm"), "The points p with normal . p <= offset_mm, LPS.");
  module.def(
      "sphere",
      [](const Numbers& centre_mm, double radius_mm) {
        return Expression(voxel::Sphere{vector_of(centre_mm, "centre_mm"), radius_mm});
      },
      py::arg("centre_mm"), py::arg("radius_mm"));
  module.def(
      "box",
      [](const Numbers& low_mm, const Numbers& high_mm) {
        return Expression(voxel::Box{vector_of(low_mm, "low_mm"), vector_of(high_mm, "high_mm")});
      },
      py::arg("low_mm"), py::arg("high_mm"));
  module.def("motion", &motion, py::arg("translate_mm") = py::none(), py::arg("degrees") = 0.0,
             py::arg("axis") = py::none(), py::arg("about_mm") = py::none(),
             "A rotation about an axis through a point, then a translation, as a matrix of LPS mm.");
  module.def(
      "move",
      [](const Expression& expression, const Numbers& moved_from_still) {
        return voxel::moved(expression, matrix_of(moved_from_still, "moved_from_still"));
      },
      py::arg("expression"), py::arg("moved_from_still"), "The expression under a rigid motion.");
}

}  // namespace octotomy::planner::python
