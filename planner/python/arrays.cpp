// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/python/arrays.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "planner/operation/table/number_format.h"
#include "voxel/space/error.h"

namespace octotomy::planner::python {
namespace {

/// Refuses an array that has another shape than (`rows`, `columns`) or a number that is not finite. `rows` =
/// -1 allows any number of rows; `rows` = 0 requires one dimension with `columns` numbers.
void check_shape(const Numbers& numbers, const char* what, int rows, int columns) {
  const bool fits = rows == 0 ? numbers.ndim() == 1 && numbers.shape(0) == columns
                              : numbers.ndim() == 2 && numbers.shape(1) == columns &&
                                    (rows < 0 || numbers.shape(0) == rows);
  const std::string shape = rows == 0  ? "(" + std::to_string(columns) + ",)"
                            : rows < 0 ? "(n, " + std::to_string(columns) + ")"
                                       : "(" + std::to_string(rows) + ", " + std::to_string(columns) + ")";
  if (!fits) throw voxel::InvalidInput(std::string(what) + " must be an array of the shape " + shape);
  for (py::ssize_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers.data()[i]))
      throw voxel::InvalidInput(std::string(what) + " has a number that is not finite");
}

}  // namespace

glm::dvec3 vector_of(const Numbers& numbers, const char* what) {
  check_shape(numbers, what, 0, 3);
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

std::vector<glm::dvec2> points_2d_of(const Numbers& numbers, const char* what) {
  check_shape(numbers, what, -1, 2);
  std::vector<glm::dvec2> points;
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i) points.emplace_back(numbers.at(i, 0), numbers.at(i, 1));
  return points;
}

std::vector<glm::dvec3> points_3d_of(const Numbers& numbers, const char* what) {
  check_shape(numbers, what, -1, 3);
  std::vector<glm::dvec3> points;
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i)
    points.emplace_back(numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2));
  return points;
}

double number_from(double number, double low, double high, const char* what) {
  if (number >= low && number <= high) return number;
  if (std::isnan(number)) throw voxel::InvalidInput(std::string(what) + " is not a number");
  throw voxel::InvalidInput(std::string(what) + " is " + plain(number) + ": give " + plain(low) + " to " +
                            plain(high));
}

glm::dmat4 matrix_of(const Numbers& numbers, const char* what) {
  check_shape(numbers, what, 4, 4);
  glm::dmat4 matrix(0.0);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix[column][row] = numbers.at(row, column);
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0)
    throw voxel::InvalidInput(std::string(what) + " must end in the row 0, 0, 0, 1");
  return matrix;
}

py::str text_of(const std::string& bytes) {
  PyObject* const text =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "backslashreplace");
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

py::array array_of(const glm::dvec3& vector) {
  return py::array_t<double>(3, &vector.x);
}

py::array array_of(const glm::dmat4& matrix) {
  const glm::dmat4 rows = glm::transpose(matrix);
  return py::array_t<double>({4, 4}, &rows[0][0]);
}

py::object python_of(const nlohmann::ordered_json& json) {
  // Names of files need not be UTF-8, so invalid bytes are replaced.
  constexpr auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return py::module_::import("json").attr("loads")(json.dump(-1, ' ', false, replace));
}

}  // namespace octotomy::planner::python
