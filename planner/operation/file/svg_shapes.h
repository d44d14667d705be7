// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "planner/operation/file/xml_tags.h"

// Reads shapes of SVG 1.1 in user units: x to the right, y down. Functions throw std::runtime_error that
// names file, line and attribute if something cannot be read.
namespace octotomy::planner {

/// The length of a pixel in CSS, in which an inch has 96 pixels.
inline constexpr double mm_per_css_pixel = 25.4 / 96.0;

/// The matrix of the six numbers of an SVG transform "matrix(a b c d e f)".
glm::dmat3 affine(double a, double b, double c, double d, double e, double f);
/// The matrix of an element's `transform`; the identity if it has none.
glm::dmat3 transform_of(const XmlTags& elements, const XmlTag& element);
/// The numbers in an attribute; empty if the element lacks it.
std::vector<double> numbers_of(const XmlTags& elements, const XmlTag& element, const std::string& attribute);
/// A length in user units; `otherwise` if the attribute is missing. A percentage is refused.
double length_of(const XmlTags& elements, const XmlTag& element, const std::string& key, double otherwise,
                 double mm_per_unit);

/// The polygons of an outline: path, polygon, polyline, rect, circle or ellipse; none for other elements.
/// Curves become lines that deviate from them by at most the tolerance.
std::vector<std::vector<glm::dvec2>> polygons_of(const XmlTags& elements, const XmlTag& element,
                                                 const glm::dmat3& mm_from_user, double tolerance_mm);

}  // namespace octotomy::planner
