// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <string>
#include <vector>

namespace octotomy::planner::python {

namespace py = pybind11;

/// A read-only NumPy array of the numbers from `first` on, without a copy. The array keeps `owner` alive. The
/// last axis of `shape` is the fastest.
template <typename Number>
py::array shown(const Number* first, std::vector<py::ssize_t> shape, py::handle owner) {
  py::array array(py::dtype::of<Number>(), std::move(shape), first, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Each function throws std::invalid_argument, which names `what`, if the array has another shape or a number
/// is not finite or out of range.
glm::dvec3 vector_of(const Numbers& numbers, const char* what);
std::vector<glm::dvec2> points_2d_of(const Numbers& numbers, const char* what);
std::vector<glm::dvec3> points_3d_of(const Numbers& numbers, const char* what);
/// Checks that `number` lies from `low` to `high`, which may be infinite, and returns it.
double number_from(double number, double low, double high, const char* what);
/// A 4 x 4 matrix from its rows, as in NumPy and nibabel.
glm::dmat4 matrix_of(const Numbers& numbers, const char* what);

/// The name of a file, which may consist of any bytes, as a Python string. Bytes that are not UTF-8 become
/// escapes such as \xff.
py::str text_of(const std::string& bytes);

py::array array_of(const glm::dvec3& vector);
py::array array_of(const glm::dmat4& matrix);

/// JSON as Python's dictionaries, lists, texts and numbers.
py::object python_of(const nlohmann::ordered_json& json);

}  // namespace octotomy::planner::python
