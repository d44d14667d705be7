// SPDX-License-Identifier: AGPL-3.0-or-later
// Scans as arrays.
#include <algorithm>
#include <cstring>
#include <memory>
#include <pybind11/operators.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <string>

#include "planner/operation/file/label_table.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/control_character.h"
#include "planner/operation/table/plan_universe.h"
#include "planner/python/arrays.h"
#include "planner/python/module.h"
#include "planner/python/waiting.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/error.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::planner::python {
namespace {

using voxel::Scene;

const std::pair<const char*, voxel::Meaning> meanings[] = {
    {"HU", voxel::Meaning::Hounsfield}, {"raw", voxel::Meaning::Raw}, {"label", voxel::Meaning::Label}};

std::string meaning_of(const Scene& scene) {
  for (const auto& [name, meaning] : meanings)
    if (meaning == scene.meaning) return name;
  return "raw";
}

/// A copy of an array's samples, which the scan then owns.
template <typename Sample>
voxel::Samples<Sample> samples_of(const py::array& array) {
  const auto dense = py::array_t<Sample, py::array::c_style>::ensure(array);
  voxel::Samples<Sample> samples(static_cast<std::size_t>(dense.size()));
  std::memcpy(samples.data(), dense.data(), samples.size() * sizeof(Sample));
  return samples;
}

std::shared_ptr<Scene> scene_of(const py::array& array, const Numbers& lps_from_voxel,
                                const std::string& meaning, const std::string& modality) {
  if (array.ndim() != 3) throw voxel::InvalidInput("samples must be an array of the shape (z, y, x)");
  auto scene = std::make_shared<Scene>();
  scene->lattice.dims = {array.shape(2), array.shape(1), array.shape(0)};
  scene->lattice.lps_from_voxel = matrix_of(lps_from_voxel, "lps_from_voxel");
  if (py::isinstance<py::array_t<std::int16_t>>(array))
    scene->samples = samples_of<std::int16_t>(array);
  else if (py::isinstance<py::array_t<float>>(array))
    scene->samples = samples_of<float>(array);
  else
    throw voxel::InvalidInput("samples must be of the type int16 or float32: use samples.astype()");
  const auto* known = std::find_if(std::begin(meanings), std::end(meanings),
                                   [&](const auto& m) { return m.first == meaning; });
  if (known == std::end(meanings))
    throw voxel::InvalidInput("meaning must be 'HU', 'raw' or 'label', not '" + meaning + "'");
  scene->meaning = known->second;
  if (has_control(modality))
    throw voxel::InvalidInput("modality must have no control characters: give DICOM's two letters");
  scene->modality = modality;
  scene->source = "an array";
  voxel::check(*scene);
  return scene;
}

py::array shown_samples(const py::object& self) {
  const auto& scene = self.cast<const Scene&>();
  const glm::ivec3 dims = scene.lattice.dims;
  return std::visit(
      [&](const auto& samples) {
        return shown(samples.data(), {dims.z, dims.y, dims.x}, self);
      },
      scene.samples);
}

std::shared_ptr<Scene> read_scan(const std::filesystem::path& path, const std::string& series,
                                 const std::optional<Numbers>& spacing_mm,
                                 const std::optional<std::string>& frame,
                                 const std::optional<std::string>& unit, bool join) {
  voxel::ReadOptions options;
  options.series = series;
  options.join = join;
  if (frame) options.frame = voxel::parse_frame(*frame);
  if (unit) options.unit = voxel::parse_unit(*unit);
  if (spacing_mm) options.spacing_mm = vector_of(*spacing_mm, "spacing_mm");
  return without_lock([&](const std::stop_token& stop) {
    options.progress.stop = stop;
    return std::make_shared<Scene>(voxel::read_scene(path, options));
  });
}

}  // namespace

void add_scans(py::module_& module) {
  py::class_<voxel::Universe>(module, "Universe", "The cube of 2^depth voxels a side in which octrees live.")
      .def(py::init([](int depth, const Numbers& lps_from_voxel) {
             if (depth < 2 || depth > voxel::Universe::max_depth)
               throw voxel::InvalidInput("depth must be 2 to 12");
             return voxel::Universe{depth, matrix_of(lps_from_voxel, "lps_from_voxel")};
           }),
           py::arg("depth"), py::arg("lps_from_voxel"))
      .def_readonly("depth", &voxel::Universe::depth)
      .def_property_readonly("side", &voxel::Universe::side)
      .def_property_readonly(
          "lps_from_voxel", [](const voxel::Universe& universe) { return array_of(universe.lps_from_voxel); })
      .def(py::self == py::self);

  py::class_<voxel::GreyOctree>(module, "GreyOctree",
                                "Samples at a universe's voxels, with the least and greatest of each block.")
      .def_property_readonly("universe", &voxel::GreyOctree::universe)
      .def_property_readonly("bytes", &voxel::GreyOctree::bytes_memory);

  py::class_<Scene, std::shared_ptr<Scene>>(module, "Scan", "Samples on a lattice in LPS millimetres.")
      .def(py::init(&scene_of), py::arg("samples"), py::arg("lps_from_voxel"), py::arg("meaning") = "HU",
           py::arg("modality") = "CT",
           "Copies an array of the shape (z, y, x), int16 or float32. lps_from_voxel maps (x, y, z).")
      .def_property_readonly("samples", &shown_samples, "The samples (z, y, x); not a copy, not writable.")
      .def_property_readonly("lps_from_voxel",
                             [](const Scene& scene) { return array_of(scene.lattice.lps_from_voxel); })
      .def_property_readonly("spacing_mm",
                             [](const Scene& scene) { return array_of(scene.lattice.spacing_mm()); })
      .def_property_readonly("meaning", &meaning_of)
      .def_property_readonly("unit", [](const Scene& scene) { return voxel::unit(scene); })
      .def_readonly("modality", &Scene::modality)
      .def_readonly("padding", &Scene::padding,
                    "The sample of places where the scanner measured nothing, below all measured ones; None "
                    "if there are no such places.")
      .def_property_readonly("source", [](const Scene& scene) { return text_of(scene.source); })
      .def_property_readonly("audit", [](const Scene& scene) { return python_of(to_json(scene.audit)); })
      .def(
          "universe",
          [](const Scene& scene, std::optional<double> voxel_mm) { return universe_of(scene, voxel_mm); },
          py::arg("voxel_mm") = py::none(),
          "The universe of a plan on this scan; by default as fine as the scan, at most 512 voxels a side.")
      .def(
          "grey",
          [](const std::shared_ptr<Scene>& scene, const std::optional<voxel::Universe>& universe) {
            const voxel::Universe where = universe ? *universe : universe_of(*scene, std::nullopt);
            return without_lock([&](const std::stop_token&) {
              return voxel::grey_octree_of(where, *scene).with_scan(scene);
            });
          },
          py::arg("universe") = py::none(), "The samples at the voxels of a universe.")
      .def(
          "write",
          [](const Scene& scene, const std::filesystem::path& path) {
            without_lock([&](const std::stop_token&) {
              const std::map<int, std::string> names = names_of_labels(scene, scene.source).names;
              if (!names.empty()) need_label_table(path, names);
              voxel::write_scene(scene, path);
              if (!names.empty()) write_label_table(path, names);
            });
          },
          py::arg("path"),
          "Writes .nrrd, .nii, .nii.gz or .mha, by the name's extension. The names of the labels of a label "
          "map that "
          "was read from a file are written beside it, as .tsv.");

  module.def("read_scan", &read_scan, py::arg("path"), py::arg("series") = "",
             py::arg("spacing_mm") = py::none(), py::arg("frame") = py::none(), py::arg("unit") = py::none(),
             py::arg("join") = false,
             "Reads a scan: DICOM folder or file, NIfTI, NRRD, MetaImage, images. `series` chooses a DICOM "
             "series by number, UID or part of its description; `join` combines slices of one geometry whose "
             "identifiers differ; the audit then has a FAIL. `frame` (\"RAS\") and `unit` (\"um\") "
             "replace statements that the file omits or makes wrongly.");
}

}  // namespace octotomy::planner::python
