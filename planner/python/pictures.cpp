// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures as arrays.
#include <algorithm>
#include <limits>
#include <memory>
#include <pybind11/stl.h>

#include "planner/python/arrays.h"
#include "planner/python/module.h"
#include "planner/python/waiting.h"
#include "voxel/space/error.h"
#include "voxel/view/render.h"

namespace octotomy::planner::python {
namespace {

using voxel::Picture;
using SharedPicture = std::shared_ptr<Picture>;

/// Largest number of pixels along a side of a picture.
constexpr int most_px = 8192;

voxel::DrawnObject drawn(const voxel::Octree& octree, const std::optional<voxel::GreyOctree>& grey,
                         double threshold, const std::optional<std::array<float, 3>>& colour, float opacity) {
  voxel::DrawnObject object{"", octree};
  object.grey = grey;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  object.threshold = number_from(threshold, -infinite, infinite, "threshold");
  for (int channel = 0; colour && channel < 3; ++channel)
    object.colour[channel] = static_cast<float>(
        number_from((*colour)[static_cast<std::size_t>(channel)], 0.0, 1.0, "a part of colour"));
  object.opacity = static_cast<float>(number_from(opacity, 0.0, 1.0, "opacity"));
  return object;
}

SharedPicture render(const std::vector<voxel::DrawnObject>& objects, const std::string& view,
                     std::pair<int, int> size_px, const std::optional<double>& width_mm) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view(view);
  for (const int side_px : {size_px.first, size_px.second})
    number_from(side_px, 1.0, most_px, "a side of size_px");
  options.size_px = {size_px.first, size_px.second};
  options.width_mm = width_mm;
  const bool all_grey = std::all_of(objects.begin(), objects.end(),
                                    [](const voxel::DrawnObject& object) { return object.grey.has_value(); });
  options.shading = all_grey ? voxel::Shading::PartialVolume : voxel::Shading::Gradient;
  return without_lock(
      [&](const std::stop_token&) { return std::make_shared<Picture>(voxel::render(objects, options)); });
}

}  // namespace

void add_pictures(py::module_& module) {
  py::class_<voxel::DrawnObject>(module, "Drawn", "An object to draw, its colour 0 to 1 in sRGB.")
      .def(py::init(&drawn), py::arg("octree"), py::arg("grey") = py::none(), py::arg("threshold") = 0.0,
           py::arg("colour") = py::none(), py::arg("opacity") = 1.0f,
           "With `grey`, its surface lies where the samples reach `threshold`; without, its surface is that "
           "of its voxels.");
  py::class_<Picture, SharedPicture>(module, "Picture", "A picture with the depth and object of every pixel.")
      .def_property_readonly(
          "rgb",
          [](const py::object& self) {
            const auto& picture = self.cast<const Picture&>();
            return shown(picture.rgb.data(), {picture.size_px.y, picture.size_px.x, 3}, self);
          },
          "The colours (height, width, 3), uint8; not a copy.")
      .def_property_readonly(
          "depth_mm",
          [](const py::object& self) {
            const auto& picture = self.cast<const Picture&>();
            return shown(picture.depth_mm.data(), {picture.size_px.y, picture.size_px.x}, self);
          },
          "The depths along the view (height, width), float32; infinite where there is nothing; not a copy.")
      .def_property_readonly(
          "object",
          [](const py::object& self) {
            const auto& picture = self.cast<const Picture&>();
            return shown(picture.object.data(), {picture.size_px.y, picture.size_px.x}, self);
          },
          "The number of the visible object (height, width), int16; -1 where there is none; not a copy.")
      .def_readonly("pixel_mm", &Picture::pixel_mm)
      .def(
          "point_mm",
          [](const Picture& picture, int x, int y) -> py::object {
            if (x < 0 || y < 0 || x >= picture.size_px.x || y >= picture.size_px.y)
              throw voxel::InvalidInput("the pixel lies outside the picture");
            const auto point = picture.point_mm({x, y});
            return point ? py::object(array_of(*point)) : py::object(py::none());
          },
          py::arg("x"), py::arg("y"), "The LPS point that a pixel shows, or None.");
  module.def("render", &render, py::arg("objects"), py::arg("view") = "anterior",
             py::arg("size_px") = std::pair(512, 512), py::arg("width_mm") = py::none(),
             "Draws objects of one universe, orthographic: a named view, or 'AZ,EL' in degrees.");
}

}  // namespace octotomy::planner::python
