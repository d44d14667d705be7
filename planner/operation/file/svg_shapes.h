// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "planner/operation/file/xml_tags.h"

// Shapes of SVG 1.1, in user units: x to the right, y down. Functions throw std::runtime_error with file,
// line and attribute if something cannot be read.
namespace octotomy::planner {

/// CSS: an inch has 96 pixels.
inline constexpr double mm_per_css_pixel = 25.4 / 96.0;

/// The matrix of an SVG transform's six numbers.
glm::dmat3 affine(double a, double b, double c, double d, double e, double f);
/// The matrix of an element's `transform`; the identity if it has none.
glm::dmat3 transform_of(const XmlTags& elements, const XmlTag& element);
/// The numbers of an attribute; empty without one.
std::vector<double> numbers_of(const XmlTags& elements, const XmlTag& element, const std::string& attribute);
/// A length in user units; percents have none.
double length_of(const XmlTags& elements, const XmlTag& element, const std::string& key, double otherwise,
                 double mm_per_unit);

/// The polygons that an outline draws: path, polygon, polyline, rect, circle or ellipse; none for other
/// elements. Curves become lines that are nowhere farther from them than the tolerance.
std::vector<std::vector<glm::dvec2>> polygons_of(const XmlTags& elements, const XmlTag& element,
                                                 const glm::dmat3& mm_from_user, double tolerance_mm);

}  // namespace octotomy::planner
