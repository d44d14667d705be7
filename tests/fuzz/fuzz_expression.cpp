// SPDX-License-Identifier: AGPL-3.0-or-later
// Any text is an expression or is refused with std::invalid_argument; an expression is printed as it is read.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "voxel/solid/expression.h"

namespace {

using octotomy::voxel::Expression;

// Objects are half-spaces, told apart by their offset: the number of their name.
struct Dictionary {
  std::vector<std::string> objects, motions;

  double number(std::vector<std::string>& names, std::string_view name) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return static_cast<double>(i);
    names.emplace_back(name);
    return static_cast<double>(names.size() - 1);
  }
  octotomy::voxel::Names names() {
    return {[this](std::string_view name) -> Expression {
              return octotomy::voxel::HalfSpace{{0, 0, 1}, number(objects, name)};
            },
            [this](std::string_view name) {
              glm::dmat4 shift(1.0);
              shift[3][0] = number(motions, name);
              return shift;
            }};
  }
  octotomy::voxel::Labels labels() const {
    return {[this](const Expression::Leaf& leaf) {
              const auto number = std::get<octotomy::voxel::HalfSpace>(leaf).offset_mm;
              return objects.at(static_cast<std::size_t>(number));
            },
            [this](const glm::dmat4& shift) { return motions.at(static_cast<std::size_t>(shift[3][0])); }};
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  Dictionary dictionary;
  std::string printed;
  try {
    printed = print_expression(parse_expression(text, dictionary.names()), dictionary.labels());
  } catch (const std::invalid_argument&) {
    return 0;
  }
  // A printed expression must be readable, and must print the same.
  const Expression again = parse_expression(printed, dictionary.names());
  if (print_expression(again, dictionary.labels()) != printed) std::abort();
  if (octotomy::voxel::names_in(text) != octotomy::voxel::names_in(printed)) std::abort();
  return 0;
}
