// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/table/record.h"
#include "planner/procedure/cephalometry/measured.h"

// Cephalometric measures in the form of a result's `cephalometry`.
namespace octotomy::planner {

constexpr auto members_of(const CephalometricValue&) {
  using V = CephalometricValue;
  return std::tuple(member("value", &V::value), member("half_width", &V::half_width));
}

struct CephalometryRow {
  std::string name, says, unit;
  std::optional<CephalometricValue> before, after, change;
  std::optional<double> norm, deviation;
  std::string source;
  std::optional<std::string> norm_of;
};
constexpr auto members_of(const CephalometryRow&) {
  using R = CephalometryRow;
  return std::tuple(member("name", &R::name), member("says", &R::says), member("unit", &R::unit),
                    member("before", &R::before), member("after", &R::after), member("change", &R::change),
                    member("norm", &R::norm), member("deviation", &R::deviation),
                    member("source", &R::source), member_if_any("norm_of", &R::norm_of));
}

/// A measure without a value, before or after the operation.
struct LackingMeasure {
  std::string name;
  std::vector<std::string> landmarks;  ///< those that are not placed, or whose motion is not known
};
constexpr auto members_of(const LackingMeasure&) {
  return std::tuple(member("name", &LackingMeasure::name), member("landmarks", &LackingMeasure::landmarks));
}

struct CephalometryTable {
  std::vector<CephalometryRow> measures;
  std::vector<LackingMeasure> not_predicted, lacking;
  double landmark_deviation_mm = 0.0, coverage = 0.0;
};
constexpr auto members_of(const CephalometryTable&) {
  using T = CephalometryTable;
  return std::tuple(member("measures", &T::measures), member_if_any("not_predicted", &T::not_predicted),
                    member("lacking", &T::lacking),
                    member("landmark_deviation_mm", &T::landmark_deviation_mm),
                    member("coverage", &T::coverage));
}

}  // namespace octotomy::planner
