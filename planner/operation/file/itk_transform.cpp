// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/itk_transform.h"

#include <array>
#include <charconv>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "planner/operation/file/read_hdf5.h"
#include "planner/operation/file/write_hdf5.h"
#include "planner/operation/table/json_file.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

/// A transform with the type and numbers that the file states for it.
struct ListedTransform {
  std::string type;  ///< "AffineTransform"
  std::string where;
  std::vector<double> parameters, fixed;
};

/// Files of linear transforms have a few hundred bytes; larger files are refused, because they contain
/// something else.
constexpr std::uintmax_t most_bytes = 1 << 20;

std::vector<double> numbers_of(const std::string& text, const std::string& where) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number))
      refuse(where, "'" + word.substr(0, 40) + "' is not a finite number");
    numbers.push_back(number);
  }
  return numbers;
}

/// A type without its ending: "AffineTransform" for "AffineTransform_double_3_3".
std::string type_of_word(const std::string& word, const std::string& where) {
  for (const std::string_view ending : {"_double_3_3", "_float_3_3"})
    if (word.ends_with(ending)) return word.substr(0, word.size() - ending.size());
  refuse(where, "'" + word.substr(0, 60) +
                    "' is not a transform of three-dimensional points: its name must end in _double_3_3");
}

std::vector<ListedTransform> listed_text(const std::string& text, const std::string& file) {
  std::istringstream lines(text);
  std::vector<ListedTransform> found;
  std::string line;
  int number = 0;
  bool is_first = true;
  while (std::getline(lines, line)) {
    ++number;
    line = voxel::trimmed(line);
    if (is_first && !line.starts_with("#Insight Transform File"))
      refuse(file,
             "is not a transform of ITK: its text does not begin with '#Insight Transform File', and it has "
             "no HDF5 signature; save the transform in 3D Slicer as .tfm or .h5");
    is_first = false;
    if (line.empty() || line.front() == '#') continue;
    const std::string where = file + ", line " + std::to_string(number);
    const auto colon = line.find(':');
    const std::string key = line.substr(0, colon);
    const std::string value = colon == std::string::npos ? "" : voxel::trimmed(line.substr(colon + 1));
    if (key == "Transform") {
      found.push_back({type_of_word(value, where), where, {}, {}});
    } else if ((key == "Parameters" || key == "FixedParameters") && !found.empty()) {
      (key == "Parameters" ? found.back().parameters : found.back().fixed) = numbers_of(value, where);
    } else {
      refuse(where, "'" + key.substr(0, 40) +
                        "' is none of Transform, Parameters and FixedParameters, or stands before the first "
                        "Transform: save the transform in 3D Slicer as .tfm or .h5");
    }
  }
  return found;
}

/// The numbers of a transform's member, such as "Parameters"; empty if there is none. ITK before version 5
/// misspells the members' names as "Tranform...".
std::vector<double> numbers_in(const Hdf5File& file, const std::string& group, const std::string& name) {
  for (const char* const before : {"/Transform", "/Tranform"})
    if (const std::string path = group + before + name; file.has(path)) return file.numbers(path);
  return {};
}

std::vector<ListedTransform> listed_hdf5(const std::string& bytes, const std::string& name) {
  std::vector<ListedTransform> found;
  try {
    const Hdf5File file(bytes);
    if (!file.has("/TransformGroup"))
      refuse("",
             "has no /TransformGroup, so it is not a file of ITK's transforms: save the transform in 3D "
             "Slicer as .h5");
    constexpr std::size_t most_transforms = 64;
    const std::size_t count = file.members("/TransformGroup").size();
    if (count > most_transforms)
      refuse("", "holds " + std::to_string(count) +
                     " transforms, and at most 64 can be read: save a single linear transform");
    for (std::size_t i = 0; i < count; ++i) {
      const std::string group = "/TransformGroup/" + std::to_string(i), where = name + ", " + group;
      if (!file.has(group))
        refuse("", "has no " + group +
                       ", because its transforms are not numbered from 0: save it anew in 3D Slicer");
      found.push_back({type_of_word(file.text(group + "/TransformType"), where), where, {}, {}});
      if (found.back().type == "CompositeTransform") continue;
      found.back().parameters = numbers_in(file, group, "Parameters");
      found.back().fixed = numbers_in(file, group, "FixedParameters");
    }
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    if (what.starts_with(name)) throw;
    refuse(name, what);
  }
  return found;
}

std::vector<ListedTransform> listed(const std::filesystem::path& path) {
  const std::string file = path.string();
  if (!std::filesystem::is_regular_file(path)) refuse(file, "is no file");
  if (std::filesystem::file_size(path) > most_bytes)
    refuse(file, "is larger than any file of a linear transform: save a linear transform without a grid");
  const std::string bytes = voxel::file_bytes(path);
  std::vector<ListedTransform> found =
      Hdf5File::begins(bytes) ? listed_hdf5(bytes, file) : listed_text(bytes, file);
  if (found.empty()) refuse(file, "holds no transform");
  return found;
}

void need_count(const ListedTransform& each, std::size_t count) {
  if (each.parameters.size() != count)
    refuse(each.where, each.type + " has " + std::to_string(each.parameters.size()) +
                           " parameters: it takes " + std::to_string(count));
}

glm::dvec3 three(const std::vector<double>& numbers, std::size_t from) {
  return {numbers[from], numbers[from + 1], numbers[from + 2]};
}

/// The matrix of the map x -> turn (x - centre) + centre + shift.
glm::dmat4 about_centre(const glm::dmat3& turn, const glm::dvec3& shift, const ListedTransform& each) {
  if (each.fixed.size() != 3 && each.fixed.size() != 4 && !each.fixed.empty())
    refuse(each.where, each.type + " has " + std::to_string(each.fixed.size()) +
                           " fixed parameters instead of the three coordinates of its centre");
  const glm::dvec3 centre = each.fixed.empty() ? glm::dvec3(0.0) : three(each.fixed, 0);
  glm::dmat4 matrix(turn);
  // The sum in this order is exact if the centre is zero.
  matrix[3] = glm::dvec4(shift + (centre - turn * centre), 1.0);
  return matrix;
}

glm::dmat3 euler(const ListedTransform& each) {
  const auto about = [&](std::size_t axis) {
    glm::dvec3 direction(0.0);
    direction[static_cast<int>(axis)] = 1.0;
    return glm::dmat3(glm::rotate(glm::dmat4(1.0), each.parameters[axis], direction));
  };
  const bool is_zyx = each.fixed.size() == 4 && each.fixed[3] != 0.0;
  return is_zyx ? about(2) * about(1) * about(0) : about(2) * about(0) * about(1);
}

glm::dmat3 versor(const ListedTransform& each) {
  const glm::dvec3 v = three(each.parameters, 0);
  const double square = glm::dot(v, v);
  // The three numbers of a half turn's versor may be slightly longer than 1 after a file rounded them.
  if (square > 1.0 + 1e-6)
    refuse(each.where, "the vector of its versor is longer than 1, so it is not a rotation");
  return glm::mat3_cast(glm::normalize(glm::dquat(std::sqrt(std::max(0.0, 1.0 - square)), v.x, v.y, v.z)));
}

glm::dmat4 matrix_of(const ListedTransform& each) {
  const std::string& type = each.type;
  if (type == "IdentityTransform") return glm::dmat4(1.0);
  if (type == "TranslationTransform") {
    need_count(each, 3);
    return glm::translate(glm::dmat4(1.0), three(each.parameters, 0));
  }
  if (type == "AffineTransform" || type == "MatrixOffsetTransformBase" || type == "Rigid3DTransform") {
    need_count(each, 12);
    glm::dmat3 turn;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        turn[column][row] = each.parameters[static_cast<std::size_t>(3 * row + column)];
    return about_centre(turn, three(each.parameters, 9), each);
  }
  if (type == "Euler3DTransform" || type == "VersorRigid3DTransform") {
    need_count(each, 6);
    return about_centre(type == "Euler3DTransform" ? euler(each) : versor(each), three(each.parameters, 3),
                        each);
  }
  refuse(each.where, "'" + type +
                         "' cannot be read, because it is not linear: save a linear transform from 3D "
                         "Slicer's module Transforms, without grids or splines");
}

/// The shortest decimal text from which the same number is read.
std::string exact(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace

TransformFile read_itk_transform(const std::filesystem::path& path) {
  std::vector<ListedTransform> all = listed(path);
  const bool is_composite = all.front().type == "CompositeTransform";
  if (is_composite) all.erase(all.begin());
  if (all.empty()) refuse(path.string(), "has a composite transform without parts");
  if (all.size() > 1 && !is_composite)
    refuse(path.string(), "holds " + std::to_string(all.size()) +
                              " transforms, but no composite transform that states their order: save each "
                              "transform in its own file");
  glm::dmat4 still_from_moved(1.0);
  for (const ListedTransform& each : all) still_from_moved = still_from_moved * matrix_of(each);
  if (std::abs(glm::determinant(glm::dmat3(still_from_moved))) < 1e-6)
    refuse(path.string(), "its transform has no inverse, because its matrix is singular");
  return {
      glm::inverse(still_from_moved),
      {path.filename().string() + ": like all ITK transforms it is in LPS and mm and maps positions after "
                                  "the motion to positions before it, so the motion is its inverse"}};
}

std::string itk_transform_hdf5(const glm::dmat4& moved_from_still) {
  const glm::dmat4 still_from_moved = glm::inverse(moved_from_still);
  std::vector<double> parameters;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) parameters.push_back(still_from_moved[column][row]);
  for (int row = 0; row < 3; ++row) parameters.push_back(still_from_moved[3][row]);
  Hdf5Group transform;
  transform.members = {{"TransformType", std::string("AffineTransform_double_3_3")},
                       {"TranformParameters", std::move(parameters)},
                       {"TranformFixedParameters", std::vector<double>(3, 0.0)}};
  Hdf5Group list, root;
  list.members.emplace("0", std::move(transform));
  root.members.emplace("TransformGroup", std::move(list));
  return hdf5_bytes(root);
}

std::string itk_transform_text(const glm::dmat4& moved_from_still) {
  const glm::dmat4 still_from_moved = glm::inverse(moved_from_still);
  std::string text =
      "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\nParameters:";
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) text += " " + exact(still_from_moved[column][row]);
  for (int row = 0; row < 3; ++row) text += " " + exact(still_from_moved[3][row]);
  return text + "\nFixedParameters: 0 0 0\n";
}

}  // namespace octotomy::planner
