// SPDX-License-Identifier: AGPL-3.0-or-later
// Shapes of SVG 1.1: elements are read in their order, each with the transforms of the groups that hold it;
// outlines are taken to millimetres before curves become lines, so that the tolerance is one of millimetres.
#include "planner/file/svg_outlines.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>

#include "planner/table/json_file.h"
#include "planner/table/number_format.h"
#include "voxel/space/regular_file.h"

namespace octotomy::planner {
namespace {

constexpr double mm_per_inch = 25.4;
/// CSS: an inch has 96 pixels.
constexpr double mm_per_css_pixel = mm_per_inch / 96.0;
/// More lines than that in one curve say that its numbers are wrong.
constexpr double most_lines = 100000.0;

using Attributes = std::map<std::string, std::string>;

struct Element {
  std::string name;  ///< without a namespace; empty at the file's end
  Attributes attributes;
  bool begins = true, ends = false;  ///< <a/> does both
  std::size_t line = 1;
};

/// Elements of an XML text, one after the other; text between them is passed over.
class Elements {
 public:
  Elements(std::string file, const std::string& text) : file_(std::move(file)), text_(text) {}

  Element next() {
    while (true) {
      pass_to("<", false);
      if (at_ == text_.size()) return {"", {}, true, false, line_};
      if (accept("<!--")) {
        pass_to("-->", true);
      } else if (accept("<![CDATA[")) {
        pass_to("]]>", true);
      } else if (accept("<?")) {
        pass_to("?>", true);
      } else if (accept("<!")) {
        pass_declaration();
      } else {
        return element();
      }
    }
  }
  [[noreturn]] void refuse_at(std::size_t line, const std::string& why) const {
    refuse(file_ + ", line " + std::to_string(line), why);
  }

 private:
  bool accept(std::string_view expected) {
    if (std::string_view(text_).substr(at_, expected.size()) != expected) return false;
    for (std::size_t i = 0; i < expected.size(); ++i) advance();
    return true;
  }
  void advance() {
    if (text_[at_++] == '\n') ++line_;
  }
  /// To the mark, or behind it where it must come.
  void pass_to(std::string_view mark, bool behind) {
    const std::size_t begun = line_, found = text_.find(mark, at_);
    if (behind && found == std::string::npos) refuse_at(begun, "is not closed by " + std::string(mark));
    const std::size_t to = found == std::string::npos ? text_.size() : found + (behind ? mark.size() : 0);
    while (at_ < to) advance();
  }
  /// A document type may hold declarations in brackets. Entities of one's own are not expanded.
  void pass_declaration() {
    const std::size_t end = text_.find_first_of("[>", at_);
    if (end != std::string::npos && text_[end] == '[') pass_to("]", true);
    pass_to(">", true);
  }
  void skip_spaces() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) advance();
  }
  std::string name() {
    std::string read;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0 &&
           std::string_view("=/><\"'").find(text_[at_]) == std::string_view::npos) {
      read += text_[at_];
      advance();
    }
    return read;
  }
  Element element() {
    Element read;
    read.line = line_;
    accept("<");
    read.begins = !accept("/");
    read.ends = !read.begins;
    read.name = name();
    if (read.name.empty()) refuse_at(line_, "a '<' begins no element: is this an SVG file?");
    if (const auto colon = read.name.find(':'); colon != std::string::npos)
      read.name = read.name.starts_with("svg:") ? read.name.substr(4) : "foreign";
    while (true) {
      skip_spaces();
      if (accept("/>")) return read.ends = true, read;
      if (accept(">")) return read;
      attribute(read);
    }
  }
  void attribute(Element& read) {
    const std::string key = name();
    skip_spaces();
    const bool equals = accept("=");
    skip_spaces();
    if (key.empty() || !equals || at_ == text_.size() || (text_[at_] != '"' && text_[at_] != '\''))
      refuse_at(line_, "<" + read.name + "> has an attribute that is not NAME=\"VALUE\"");
    const char quote = text_[at_];
    const std::size_t begun = line_;
    advance();
    std::string value;
    for (; at_ < text_.size() && text_[at_] != quote; advance()) value += text_[at_];
    if (at_ == text_.size()) refuse_at(begun, "the value of '" + key + "' is not closed");
    advance();
    for (const auto& [entity, letter] :
         {std::pair("&lt;", "<"), {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}})
      for (std::size_t found = 0; (found = value.find(entity, found)) != std::string::npos; ++found)
        value.replace(found, std::string_view(entity).size(), letter);
    read.attributes[key] = value;
  }

  std::string file_;
  const std::string& text_;
  std::size_t at_ = 0, line_ = 1;
};

/// Numbers and letters of a path, a list of points or a transform.
class Words {
 public:
  Words(const Elements& elements, const Element& element, std::string attribute)
      : elements_(elements), element_(element), attribute_(std::move(attribute)) {
    if (const auto found = element.attributes.find(attribute_); found != element.attributes.end())
      text_ = found->second;
  }

  bool at_end() {
    skip();
    return at_ >= text_.size();
  }
  /// The next letter, or 0.
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
    // std::strtod would take "inf", "nan" and hexadecimal numbers, too.
    const std::size_t end = std::min(text_.find_first_not_of("0123456789+-.eE", at_), text_.size());
    const std::string digits = text_.substr(at_, end - at_);
    char* rest = nullptr;
    const double value = std::strtod(digits.c_str(), &rest);
    if (rest == digits.c_str() || !std::isfinite(value)) refuse_here("a number");
    at_ += static_cast<std::size_t>(rest - digits.c_str());
    return value;
  }
  /// 0 or 1, which may stand without a blank behind it.
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
  const Elements& elements_;
  const Element& element_;
  std::string attribute_, text_;
  std::size_t at_ = 0;
};

glm::dmat3 affine(double a, double b, double c, double d, double e, double f) {
  return {{a, b, 0.0}, {c, d, 0.0}, {e, f, 1.0}};
}

glm::dvec2 at(const glm::dmat3& map, const glm::dvec2& p) {
  return glm::dvec2(map * glm::dvec3(p, 1.0));
}

glm::dmat3 transform_of(const Elements& elements, const Element& element) {
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
                                           std::to_string(n.size()) + " numbers, which is none of SVG's");
    }
  }
  return made;
}

/// A length in user units; percents have none.
double length_of(const Elements& elements, const Element& element, const std::string& key, double otherwise,
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
                                         "' is no length in px, mm, cm, "
                                         "in, pt or pc");
  // A unit within the drawing is one of CSS: a pixel is a user unit.
  return value * known->second / mm_per_unit;
}

/// Draws outlines in user units as polygons in millimetres.
class Pencil {
 public:
  Pencil(const glm::dmat3& mm_from_user, double tolerance_mm) : map_(mm_from_user), tolerance_(tolerance_mm) {
    const glm::dmat2 linear(map_);
    // The greatest stretch is at most the root of the squares' sum.
    stretch_ = std::sqrt(glm::dot(linear[0], linear[0]) + glm::dot(linear[1], linear[1]));
  }

  void begin(const glm::dvec2& p) { polygons_.emplace_back(1, at(map_, p)); }
  void line(const glm::dvec2& to) { polygons_.back().push_back(at(map_, to)); }
  /// The chords of n even parts of a curve are within |second derivative| / (8 n^2) of it (Wang's bound for
  /// Bezier curves, whose second derivative is at most degree * (degree - 1) times the second differences).
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
  /// Of an ellipse with semi-axes along its own directions, from one angle over `by`.
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

/// An elliptic arc by its ends: SVG 1.1, F.6.5.
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

void draw_path(Pencil& pencil, const Elements& elements, const Element& element) {
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
    // The reflected control point, of a curve of the same kind.
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

void draw_points(Pencil& pencil, const Elements& elements, const Element& element) {
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

/// Reads a file's elements in two walks: for the units and the picture, and for the outlines.
class Drawing {
 public:
  Drawing(std::string file, const std::string& text) : file_(std::move(file)), text_(text) {}

  /// Calls `each` for what is displayed, with the transform that holds there.
  template <typename Each>
  void walk(const Each& each) {
    Elements elements(file_, text_);
    std::vector<std::pair<std::string, glm::dmat3>> open;
    std::size_t hidden_from = none;
    for (Element element = elements.next(); !element.name.empty(); element = elements.next()) {
      if (!element.begins) {
        if (open.empty() || open.back().first != element.name)
          elements.refuse_at(element.line, "</" + element.name + "> closes what is not open");
        open.pop_back();
        if (hidden_from != none && open.size() <= hidden_from) hidden_from = none;
        continue;
      }
      if (open.empty() && element.name != "svg")
        elements.refuse_at(element.line, "is no SVG file: its root is <" + element.name + ">");
      const glm::dmat3 map = (open.empty() ? glm::dmat3(1.0) : open.back().second) *
                             (open.empty() ? glm::dmat3(1.0) : transform_of(elements, element));
      if (open.empty())
        read_root(elements, element);
      else if (hidden_from == none && !is_hidden(element))
        each(elements, element, map);
      if (element.ends) continue;
      if (hidden_from == none && !open.empty() && is_hidden(element)) hidden_from = open.size();
      open.emplace_back(element.name, map);
      if (open.size() > 1000) elements.refuse_at(element.line, "elements are nested more than 1000 deep");
    }
    if (!is_rooted_) elements.refuse_at(1, "is no SVG file: it has no element");
    if (!open.empty()) elements.refuse_at(1, "<" + open.back().first + "> is not closed");
  }

  double mm_per_unit() const { return mm_per_unit_; }
  bool has_length() const { return has_length_; }

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  static bool is_hidden(const Element& element) {
    static const std::set<std::string> apart{
        "defs",  "clipPath", "mask",   "pattern",  "symbol",  "marker",         "filter",        "style",
        "title", "desc",     "script", "metadata", "foreign", "linearGradient", "radialGradient"};
    if (apart.contains(element.name)) return true;
    const auto says = [&](const char* key, const char* what) {
      const auto found = element.attributes.find(key);
      if (found == element.attributes.end()) return false;
      std::string value = found->second;
      std::erase(value, ' ');
      return value.find(what) != std::string::npos;
    };
    return says("display", "none") || says("style", "display:none");
  }

  void read_root(const Elements& elements, const Element& root) {
    is_rooted_ = true;
    mm_per_unit_ = mm_per_css_pixel;
    const auto length_mm = [&](const char* key) -> std::optional<double> {
      const auto found = root.attributes.find(key);
      if (found == root.attributes.end() || found->second.ends_with('%')) return std::nullopt;
      const double value = length_of(elements, root, key, 0.0, 1.0);
      const bool is_bare = found->second.find_first_not_of("0123456789+-.eE ") == std::string::npos;
      return is_bare ? value * mm_per_css_pixel : value;
    };
    const std::optional<double> width_mm = length_mm("width"), height_mm = length_mm("height");
    Words box(elements, root, "viewBox");
    if (box.at_end()) {
      has_length_ = width_mm.has_value();
      return;
    }
    box.point();
    const glm::dvec2 size = box.point();
    if (!(size.x > 0.0 && size.y > 0.0)) elements.refuse_at(root.line, "viewBox has no size");
    has_length_ = width_mm || height_mm;
    if (!has_length_) return;
    const double across = width_mm ? *width_mm / size.x : *height_mm / size.y;
    const double down = height_mm ? *height_mm / size.y : across;
    if (!(across > 0.0) || std::abs(down / across - 1.0) > 1e-3)
      elements.refuse_at(root.line,
                         "width and height do not have the shape of viewBox: a unit's length cannot be told");
    mm_per_unit_ = across;
  }

  std::string file_;
  const std::string& text_;
  bool is_rooted_ = false, has_length_ = false;
  double mm_per_unit_ = mm_per_css_pixel;
};

SvgPicture picture_of(const Elements& elements, const Element& element, const glm::dmat3& map,
                      double unit_mm) {
  const auto length = [&](const char* key) { return length_of(elements, element, key, 0.0, unit_mm); };
  SvgPicture picture;
  for (const char* key : {"xlink:href", "href"})
    if (const auto found = element.attributes.find(key); found != element.attributes.end())
      picture.link = found->second;
  picture.shown_units = {length("width"), length("height")};
  const auto aspect = element.attributes.find("preserveAspectRatio");
  picture.keeps_aspect = aspect == element.attributes.end() || !aspect->second.starts_with("none");
  picture.user_from_shown = map * affine(1, 0, 0, 1, length("x"), length("y"));
  picture.line = element.line;
  if (!(picture.shown_units.x > 0.0 && picture.shown_units.y > 0.0))
    elements.refuse_at(element.line, "<image> has no width and height");
  return picture;
}

/// Whether the element is an outline; draws it.
bool draw(Pencil& pencil, const Elements& elements, const Element& element, double unit_mm) {
  const auto length = [&](const char* key, double otherwise = 0.0) {
    return length_of(elements, element, key, otherwise, unit_mm);
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
  } else {
    return false;
  }
  return true;
}

/// Without points that repeat the one before, or the first.
void add_polygon(std::vector<glm::dvec2> polygon, std::size_t line, SvgOutlines& made) {
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  while (polygon.size() > 1 && glm::distance(polygon.front(), polygon.back()) < 1e-9) polygon.pop_back();
  if (polygon.size() >= 3)
    made.polygons_mm.push_back(std::move(polygon));
  else
    made.findings.push_back("line " + std::to_string(line) +
                            ": an outline of fewer than three points is left out");
}

}  // namespace

SvgOutlines read_svg_outlines(const std::filesystem::path& path, const SvgPlacement& place,
                              double tolerance_mm) {
  voxel::need_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path.string(), "cannot be read");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  Drawing drawing(path.string(), text);
  SvgOutlines made;
  std::optional<SvgPicture> picture;
  std::map<std::string, int> left_out;
  drawing.walk([&](const Elements& elements, const Element& element, const glm::dmat3& map) {
    if (element.name == "image" && !picture)
      picture = picture_of(elements, element, map, mm_per_css_pixel);
    else if (element.name == "use" || element.name == "svg")
      elements.refuse_at(element.line,
                         "<" + element.name + "> is not read: " +
                             (element.name == "use" ? "unlink clones" : "ungroup nested drawings"));
    else if (element.name == "text" || element.name == "line")
      ++left_out[element.name];
  });
  const glm::dmat3 mm_from_user = place(drawing.mm_per_unit(), picture);
  drawing.walk([&](const Elements& elements, const Element& element, const glm::dmat3& map) {
    Pencil pencil(mm_from_user * map, tolerance_mm);
    if (draw(pencil, elements, element, mm_per_css_pixel))
      for (std::vector<glm::dvec2>& polygon : std::move(pencil).polygons())
        add_polygon(std::move(polygon), element.line, made);
  });
  if (made.polygons_mm.empty())
    refuse(path.string(), "has no outline: draw a path, polygon, polyline, rect, circle or ellipse");
  for (const auto& [name, count] : left_out)
    made.findings.push_back(std::to_string(count) + " <" + name + "> left out: it encloses nothing");
  if (!picture && !drawing.has_length())
    made.findings.push_back("the drawing has no width in millimetres: a unit is taken as 1/96 inch, " +
                            three_figures(drawing.mm_per_unit()) + " mm");
  return made;
}

}  // namespace octotomy::planner
