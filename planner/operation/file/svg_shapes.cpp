// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/svg_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

namespace octotomy::planner {
namespace {

constexpr double mm_per_inch = 25.4;
/// A curve that would need more lines than this is refused, because its numbers must be wrong.
constexpr double most_lines = 100000.0;

/// Reads the numbers and letters of a path, a list of points or a transform.
class Words {
 public:
  Words(const XmlTags& elements, const XmlTag& element, std::string attribute)
      : elements_(elements), element_(element), attribute_(std::move(attribute)) {
    if (const auto found = element.attributes.find(attribute_); found != element.attributes.end())
      text_ = found->second;
  }

  bool at_end() {
    skip();
    return at_ >= text_.size();
  }
  /// The next letter, or 0 if a number or the end comes next.
  char letter() {
    skip();
    return at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0 ? text_[at_]
                                                                                           : '\0';
  }
  char take_letter() {
    const char taken = letter();
    if (taken == '\0') refuse_here("a command");
    ++at_;
    return taken;
  }
  double number() {
    skip();
    // std::strtod is not used, because it accepts "inf", "nan" and hexadecimal numbers.
    const std::size_t end = std::min(text_.find_first_not_of("0123456789+-.eE", at_), text_.size());
    const std::string digits = text_.substr(at_, end - at_);
    char* rest = nullptr;
    const double value = std::strtod(digits.c_str(), &rest);
    if (rest == digits.c_str() || !std::isfinite(value)) refuse_here("a number");
    at_ += static_cast<std::size_t>(rest - digits.c_str());
    return value;
  }
  /// Reads 0 or 1; the next value may follow without a blank.
  bool flag() {
    skip();
    if (at_ >= text_.size() || (text_[at_] != '0' && text_[at_] != '1')) refuse_here("a flag, 0 or 1");
    return text_[at_++] == '1';
  }
  glm::dvec2 point() {
    const double x = number();
    return {x, number()};
  }
  std::string word() {
    skip();
    const std::size_t begun = at_;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return text_.substr(begun, at_ - begun);
  }
  bool accept(char expected) {
    skip();
    if (at_ >= text_.size() || text_[at_] != expected) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void refuse_here(const std::string& expected) const {
    elements_.refuse_at(element_.line,
                        "<" + element_.name + "> " + attribute_ + ", character " + std::to_string(at_ + 1) +
                            ": " + expected + " is expected" +
                            (at_ < text_.size() ? ", not '" + text_.substr(at_, 1) + "'" : ""));
  }

 private:
  void skip() {
    while (at_ < text_.size() && (text_[at_] == ',' || std::isspace(static_cast<unsigned char>(text_[at_]))))
      ++at_;
  }
  const XmlTags& elements_;
  const XmlTag& element_;
  std::string attribute_, text_;
  std::size_t at_ = 0;
};

glm::dvec2 at(const glm::dmat3& map, const glm::dvec2& p) {
  return glm::dvec2(map * glm::dvec3(p, 1.0));
}

/// Converts outlines in user units to polygons in millimetres.
class Pencil {
 public:
  Pencil(const glm::dmat3& mm_from_user, double tolerance_mm) : map_(mm_from_user), tolerance_(tolerance_mm) {
    const glm::dmat2 linear(map_);
    // The greatest stretch of a matrix is at most the root of the sum of its squared entries.
    stretch_ = std::sqrt(glm::dot(linear[0], linear[0]) + glm::dot(linear[1], linear[1]));
  }

  void begin(const glm::dvec2& p) { polygons_.emplace_back(1, at(map_, p)); }
  void line(const glm::dvec2& to) { polygons_.back().push_back(at(map_, to)); }
  /// If a curve is divided into n equal parts, their chords deviate from it by at most |second derivative| /
  /// (8 n^2) (Wang's bound). A Bezier curve's second derivative is at most degree * (degree - 1) times the
  /// largest second difference of its control points.
  void bezier(const std::vector<glm::dvec2>& controls) {
    std::vector<glm::dvec2> p;
    p.reserve(controls.size());
    for (const glm::dvec2& control : controls) p.push_back(at(map_, control));
    const std::size_t degree = p.size() - 1;
    double bend = 0.0;
    for (std::size_t i = 0; i + 2 < p.size(); ++i)
      bend = std::max(bend, glm::length(p[i] - 2.0 * p[i + 1] + p[i + 2]));
    const double second = static_cast<double>(degree * (degree - 1)) * bend;
    const int parts = parts_of(second);
    for (int part = 1; part <= parts; ++part) {
      std::vector<glm::dvec2> q = p;
      const double t = static_cast<double>(part) / parts;
      for (std::size_t left = degree; left > 0; --left)
        for (std::size_t i = 0; i < left; ++i) q[i] += t * (q[i + 1] - q[i]);
      polygons_.back().push_back(q[0]);
    }
  }
  /// Adds an arc of an ellipse from the angle `from` over the angle `by`. `map` takes the unit circle to the
  /// ellipse.
  void arc(const glm::dmat3& user_from_circle, double largest_radius, double from, double by) {
    const int parts = std::max(3, parts_of(by * by * largest_radius * stretch_));
    for (int part = 1; part <= parts; ++part) {
      const double angle = from + by * part / parts;
      line(at(user_from_circle, {std::cos(angle), std::sin(angle)}));
    }
  }
  std::vector<std::vector<glm::dvec2>> polygons() && { return std::move(polygons_); }

 private:
  int parts_of(double second_derivative_mm) const {
    return static_cast<int>(
        std::clamp(std::ceil(std::sqrt(second_derivative_mm / (8.0 * tolerance_))), 1.0, most_lines));
  }
  glm::dmat3 map_;
  double tolerance_, stretch_ = 1.0;
  std::vector<std::vector<glm::dvec2>> polygons_;
};

void draw_ellipse(Pencil& pencil, const glm::dvec2& centre, const glm::dvec2& radii) {
  pencil.begin(centre + glm::dvec2(radii.x, 0.0));
  pencil.arc(affine(radii.x, 0, 0, radii.y, centre.x, centre.y), std::max(radii.x, radii.y), 0.0,
             2.0 * std::numbers::pi);
}

/// Adds an elliptic arc that is stated by its ends: SVG 1.1, F.6.5.
void draw_arc(Pencil& pencil, const glm::dvec2& from, glm::dvec2 radii, double turn_deg, bool large,
              bool sweep, const glm::dvec2& to) {
  radii = glm::abs(radii);
  if (!(std::min(radii.x, radii.y) > 0.0) || from == to) return pencil.line(to);
  const double c = std::cos(glm::radians(turn_deg)), s = std::sin(glm::radians(turn_deg));
  const glm::dvec2 half = 0.5 * (from - to);
  const glm::dvec2 q(c * half.x + s * half.y, -s * half.x + c * half.y);
  const double reach = q.x * q.x / (radii.x * radii.x) + q.y * q.y / (radii.y * radii.y);
  if (reach > 1.0) radii *= std::sqrt(reach);
  const double share = std::sqrt(std::max(0.0, 1.0 / std::min(reach, 1.0) - 1.0)) * (large == sweep ? -1 : 1);
  const glm::dvec2 middle(share * radii.x * q.y / radii.y, -share * radii.y * q.x / radii.x);
  const auto angle = [&](const glm::dvec2& p) { return std::atan2(p.y / radii.y, p.x / radii.x); };
  const double first = angle(q - middle);
  double by = angle(-q - middle) - first;
  if (sweep && by < 0.0) by += 2.0 * std::numbers::pi;
  if (!sweep && by > 0.0) by -= 2.0 * std::numbers::pi;
  const glm::dvec2 centre =
      glm::dvec2(c * middle.x - s * middle.y, s * middle.x + c * middle.y) + 0.5 * (from + to);
  pencil.arc(affine(c * radii.x, s * radii.x, -s * radii.y, c * radii.y, centre.x, centre.y),
             std::max(radii.x, radii.y), first, by);
}

void draw_path(Pencil& pencil, const XmlTags& elements, const XmlTag& element) {
  Words words(elements, element, "d");
  glm::dvec2 here(0.0), start(0.0), handle(0.0);
  char command = '\0', before = '\0';
  bool drawing = false;
  while (!words.at_end()) {
    if (words.letter() != '\0')
      command = words.take_letter();
    else if (command == '\0' || command == 'z' || command == 'Z')
      words.refuse_here("a command");
    else if (command == 'm' || command == 'M')
      command = command == 'm' ? 'l' : 'L';  // further points of a move are lines
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command)));
    const glm::dvec2 base = kind == command ? glm::dvec2(0.0) : here;
    if (before == '\0' && kind != 'M') words.refuse_here("a path that begins with M");
    if (kind != 'M' && kind != 'Z' && !drawing) {
      pencil.begin(here);
      drawing = true;
    }
    // The last control point mirrored at the current point if the last command was a curve of the same kind;
    // else the current point.
    const auto mirrored = [&](const char* kinds) {
      return std::string_view(kinds).find(before) != std::string_view::npos ? 2.0 * here - handle : here;
    };
    glm::dvec2 to = here, first, second;
    switch (kind) {
      case 'M':
        to = start = base + words.point(), pencil.begin(to), drawing = true;
        break;
      case 'Z':
        to = start, drawing = false;
        break;
      case 'L':
        pencil.line(to = base + words.point());
        break;
      case 'H':
        pencil.line(to = {base.x + words.number(), here.y});
        break;
      case 'V':
        pencil.line(to = {here.x, base.y + words.number()});
        break;
      case 'C':
      case 'S':
        first = kind == 'S' ? mirrored("CS") : base + words.point();
        second = base + words.point(), to = base + words.point();
        pencil.bezier({here, first, second, to}), handle = second;
        break;
      case 'Q':
      case 'T':
        first = kind == 'T' ? mirrored("QT") : base + words.point();
        to = base + words.point();
        pencil.bezier({here, first, to}), handle = first;
        break;
      case 'A': {
        const glm::dvec2 radii = words.point();
        const double turn_deg = words.number();
        const bool large = words.flag(), sweep = words.flag();
        to = base + words.point();
        draw_arc(pencil, here, radii, turn_deg, large, sweep, to);
        break;
      }
      default:
        words.refuse_here("one of the commands M, L, H, V, C, S, Q, T, A, Z before");
    }
    here = to;
    before = kind;
  }
}

void draw_points(Pencil& pencil, const XmlTags& elements, const XmlTag& element) {
  Words words(elements, element, "points");
  if (!words.at_end()) pencil.begin(words.point());
  while (!words.at_end()) pencil.line(words.point());
}

void draw_rectangle(Pencil& pencil, const glm::dvec2& corner, const glm::dvec2& size, glm::dvec2 radii) {
  radii = glm::min(radii, 0.5 * size);
  if (!(std::min(radii.x, radii.y) > 0.0)) radii = glm::dvec2(0.0);
  const glm::dvec2 far = corner + size;
  pencil.begin({corner.x + radii.x, corner.y});
  const auto turn = [&](const glm::dvec2& centre, double quarter) {
    if (radii.x > 0.0)
      pencil.arc(affine(radii.x, 0, 0, radii.y, centre.x, centre.y), std::max(radii.x, radii.y),
                 quarter * std::numbers::pi / 2.0, std::numbers::pi / 2.0);
  };
  pencil.line({far.x - radii.x, corner.y}), turn({far.x - radii.x, corner.y + radii.y}, -1.0);
  pencil.line({far.x, far.y - radii.y}), turn(far - radii, 0.0);
  pencil.line({corner.x + radii.x, far.y}), turn({corner.x + radii.x, far.y - radii.y}, 1.0);
  pencil.line({corner.x, corner.y + radii.y}), turn(corner + radii, 2.0);
}

/// Adds the polygons of an element that is an outline; ignores other elements.
void draw(Pencil& pencil, const XmlTags& elements, const XmlTag& element) {
  const auto length = [&](const char* key, double otherwise = 0.0) {
    return length_of(elements, element, key, otherwise, mm_per_css_pixel);
  };
  if (element.name == "path") {
    draw_path(pencil, elements, element);
  } else if (element.name == "polygon" || element.name == "polyline") {
    draw_points(pencil, elements, element);
  } else if (element.name == "rect") {
    const double rx = length("rx", length("ry"));
    draw_rectangle(pencil, {length("x"), length("y")}, {length("width"), length("height")},
                   {rx, length("ry", rx)});
  } else if (element.name == "circle") {
    draw_ellipse(pencil, {length("cx"), length("cy")}, glm::dvec2(length("r")));
  } else if (element.name == "ellipse") {
    draw_ellipse(pencil, {length("cx"), length("cy")}, {length("rx"), length("ry")});
  }
}

}  // namespace

glm::dmat3 affine(double a, double b, double c, double d, double e, double f) {
  return {{a, b, 0.0}, {c, d, 0.0}, {e, f, 1.0}};
}

glm::dmat3 transform_of(const XmlTags& elements, const XmlTag& element) {
  Words words(elements, element, "transform");
  glm::dmat3 made(1.0);
  while (!words.at_end()) {
    const std::string kind = words.word();
    std::vector<double> n;
    if (!words.accept('(')) words.refuse_here("a transform, as translate(10, 20),");
    while (!words.accept(')')) n.push_back(words.number());
    const auto has = [&](std::size_t count) { return n.size() == count; };
    const double tangent = n.empty() ? 0.0 : std::tan(glm::radians(n[0]));
    if (kind == "matrix" && has(6)) {
      made *= affine(n[0], n[1], n[2], n[3], n[4], n[5]);
    } else if (kind == "translate" && (has(1) || has(2))) {
      made *= affine(1, 0, 0, 1, n[0], has(2) ? n[1] : 0.0);
    } else if (kind == "scale" && (has(1) || has(2))) {
      made *= affine(n[0], 0, 0, has(2) ? n[1] : n[0], 0, 0);
    } else if (kind == "rotate" && (has(1) || has(3))) {
      const double cosine = std::cos(glm::radians(n[0])), sine = std::sin(glm::radians(n[0]));
      const glm::dvec2 about = has(3) ? glm::dvec2(n[1], n[2]) : glm::dvec2(0.0);
      made *= affine(1, 0, 0, 1, about.x, about.y) * affine(cosine, sine, -sine, cosine, 0, 0) *
              affine(1, 0, 0, 1, -about.x, -about.y);
    } else if (kind == "skewX" && has(1)) {
      made *= affine(1, 0, tangent, 1, 0, 0);
    } else if (kind == "skewY" && has(1)) {
      made *= affine(1, tangent, 0, 1, 0, 0);
    } else {
      elements.refuse_at(element.line, "<" + element.name + "> has a transform '" + kind + "' with " +
                                           std::to_string(n.size()) + " numbers, which SVG does not have");
    }
  }
  return made;
}

std::vector<double> numbers_of(const XmlTags& elements, const XmlTag& element, const std::string& attribute) {
  Words words(elements, element, attribute);
  std::vector<double> numbers;
  while (!words.at_end()) numbers.push_back(words.number());
  return numbers;
}

double length_of(const XmlTags& elements, const XmlTag& element, const std::string& key, double otherwise,
                 double mm_per_unit) {
  const auto found = element.attributes.find(key);
  if (found == element.attributes.end()) return otherwise;
  Words words(elements, element, key);
  const double value = words.number();
  const std::string unit = words.word();
  if (unit.empty() && words.at_end()) return value;
  static const std::map<std::string, double> mm{
      {"px", mm_per_css_pixel}, {"mm", 1.0}, {"cm", 10.0}, {"in", mm_per_inch}, {"pt", mm_per_inch / 72.0},
      {"pc", mm_per_inch / 6.0}};
  const auto known = mm.find(unit);
  if (known == mm.end())
    elements.refuse_at(element.line, "<" + element.name + "> " + key + "='" + found->second +
                                         "' is not a length in px, mm, cm, in, pt or pc");
  // Units within the drawing are those of CSS, in which a pixel is one user unit.
  return value * known->second / mm_per_unit;
}

std::vector<std::vector<glm::dvec2>> polygons_of(const XmlTags& elements, const XmlTag& element,
                                                 const glm::dmat3& mm_from_user, double tolerance_mm) {
  Pencil pencil(mm_from_user, tolerance_mm);
  draw(pencil, elements, element);
  return std::move(pencil).polygons();
}

}  // namespace octotomy::planner
