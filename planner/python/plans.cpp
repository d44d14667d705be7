// SPDX-License-Identifier: AGPL-3.0-or-later
// Plans: the table of operations, evaluation and what it made.
#include <memory>
#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "planner/operation/measure/result_json.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan_results.h"
#include "planner/python/arrays.h"
#include "planner/python/module.h"
#include "planner/python/waiting.h"
#include "planner/result/report/report.h"
#include "planner/result/report/result_folder.h"

namespace octotomy::planner::python {
namespace {

/// The result of a plan. Python objects that refer to a part of it keep the whole result alive.
using SharedResult = std::shared_ptr<Result>;

const Object& object_of(const Result& result, const std::string& id) {
  for (const Object& object : result.evaluation.objects)
    if (object.id == id) return object;
  throw py::key_error("the plan makes no object '" + id + "'");
}

SharedResult evaluate_plan(const std::string& json, const std::filesystem::path& folder, bool certify,
                           const std::function<void(const std::string&, double)>& progress) {
  return without_lock([&](const std::stop_token& stop) {
    auto result = std::make_shared<Result>();
    result->plan = parse_plan(json, folder);
    EvaluateOptions options;
    options.stop = stop;
    options.certify = certify;
    if (progress)
      options.progress = [&progress](const std::string& doing, double fraction) {
        const py::gil_scoped_acquire held;
        progress(doing, fraction);
      };
    result->evaluation = evaluate(result->plan, options);
    return result;
  });
}

py::object written(Result& result, const std::filesystem::path& folder) {
  return python_of(without_lock([&](const std::stop_token& stop) {
    need_result_folder(folder, result_names(result.plan));
    result.pictures = plan_pictures(result.plan, result.evaluation);
    return write_result(result, folder, {stop, {}});
  }));
}

}  // namespace

void add_plans(py::module_& module) {
  module.def(
      "plan_schema", [] { return python_of(plan_schema()); },
      "The JSON schema of plans: every operation with its fields, units, ranges and defaults.");

  py::class_<Result, SharedResult>(module, "Evaluation", "The results of a plan's steps, in both kernels.")
      .def_property_readonly(
          "objects",
          [](const Result& result) {
            std::vector<std::string> names;
            for (const Object& object : result.evaluation.objects) names.push_back(object.id);
            return names;
          },
          "The names of the result's objects, in the order of their steps.")
      .def_property_readonly("universe", [](const Result& result) { return result.evaluation.universe; })
      .def(
          "octree",
          [](const Result& result, const std::string& id) { return object_of(result, id).voxel.octree; },
          py::arg("id"), "The voxel kernel's object.")
      .def(
          "solid",
          [](const Result& result, const std::string& id) { return object_of(result, id).mesh.within; },
          py::arg("id"), "The mesh kernel's object within the universe, or None where it has no answer.")
      .def(
          "record",
          [](const Result& result, const std::string& id) {
            return python_of(to_json(object_of(result, id)));
          },
          py::arg("id"), "Definition, measures and findings, as result.json has them.")
      .def(
          "certificate",
          [](const Result& result, const std::string& id) -> py::object {
            const Object& object = object_of(result, id);
            return object.certificate ? python_of(to_json(*object.certificate)) : py::object(py::none());
          },
          py::arg("id"), "The object's certificate, or None.")
      .def_property_readonly(
          "measurements",
          [](const Result& result) { return python_of(measurements_json(result.plan, result.evaluation)); })
      .def_property_readonly("timings_ms", [](const Result& result) { return result.evaluation.timings; })
      .def("write", &written, py::arg("folder"),
           "Writes the result's folder: result.json, report.html, pictures and files. Returns result.json.");

  module.def("evaluate", &evaluate_plan, py::arg("plan_json"), py::arg("folder"), py::arg("certify") = true,
             py::arg("progress") = nullptr,
             "Evaluates a plan's JSON; relative paths are relative to `folder`. `progress` is called with "
             "the name of the present stage and the fraction done.");
}

}  // namespace octotomy::planner::python
