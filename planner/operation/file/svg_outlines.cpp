// SPDX-License-Identifier: AGPL-3.0-or-later
// Shapes of SVG 1.1: elements are read in their order, each with the transforms of the groups that hold it;
// outlines are converted to millimetres before curves become lines, so that the tolerance is in millimetres.
#include "planner/operation/file/svg_outlines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "planner/operation/file/svg_shapes.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "voxel/space/file_text.h"
#include "voxel/space/regular_file.h"

namespace octotomy::planner {
namespace {

/// Larger files are refused, because the parser counts bytes in 32 bits. A drawing with an embedded picture
/// has about ten million bytes.
constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 28;

/// The length of a pixel in the program that wrote a drawing, by the drawing's comment or root. CSS has 96
/// pixels per inch; Illustrator has 72; Inkscape had 90 before version 0.92 and has 96 since.
struct PixelLength {
  int per_inch = 96;
  std::string program;  ///< "Adobe Illustrator" or a version of Inkscape; empty for other programs
  double mm() const { return 25.4 / per_inch; }
};
PixelLength pixel_of(const std::string& text) {
  const std::size_t root = text.find("<svg");
  const std::string head = text.substr(0, text.find('>', root == std::string::npos ? 0 : root));
  if (head.find("Adobe Illustrator") != std::string::npos) return {72, "Adobe Illustrator"};
  constexpr std::string_view key = "inkscape:version=\"";
  const std::size_t found = head.find(key);
  if (found == std::string::npos) return {};
  double version = 1.0;
  const char* const begin = head.data() + found + key.size();
  std::from_chars(begin, head.data() + head.size(), version);
  return version < 0.915 ? PixelLength{90, "Inkscape before 0.92"} : PixelLength{96, "Inkscape"};
}

/// The value of an element's property. Its style takes precedence over its attribute. Empty if neither states
/// the property.
std::string property_of(const XmlTag& element, const std::string& name) {
  if (const auto style = element.attributes.find("style"); style != element.attributes.end()) {
    std::istringstream declarations(style->second);
    for (std::string declaration; std::getline(declarations, declaration, ';');) {
      const std::size_t colon = declaration.find(':');
      if (colon != std::string::npos && voxel::trimmed(declaration.substr(0, colon)) == name)
        return voxel::trimmed(declaration.substr(colon + 1));
    }
  }
  const auto attribute = element.attributes.find(name);
  return attribute == element.attributes.end() ? "" : voxel::trimmed(attribute->second);
}

/// A description of an element's clip path or mask, which hides parts of its shapes, such as "the clip-path
/// of <g> (line 3)"; empty if it has neither.
std::string cut_of(const XmlTag& element) {
  for (const char* property : {"clip-path", "mask"})
    if (const std::string value = property_of(element, property); !value.empty() && value != "none")
      return std::string("the ") + property + " of <" + element.name + "> (line " +
             std::to_string(element.line) + ")";
  return {};
}

/// The elements of a drawing. They are visited twice: first for the units and the picture, then for the
/// outlines.
class Drawing {
 public:
  Drawing(std::string file, const std::string& text)
      : pixel_(pixel_of(text)), elements_(std::move(file), text) {}

  /// Calls `each` for every displayed element, with the matrix from the element's units to the drawing's.
  template <typename Each>
  void walk(const Each& each) {
    const XmlTags& elements = elements_;
    std::vector<glm::dmat3> open;
    std::vector<int> alternatives;  // for each open <switch> the number of its shapes, of which a viewer
                                    // draws one; -1 for other elements
    std::size_t hidden_from = none;
    cuts_.clear();
    for (const XmlTag& element : elements) {
      if (!element.begins) {
        open.pop_back();
        alternatives.pop_back();
        cuts_.pop_back();
        if (hidden_from != none && open.size() <= hidden_from) hidden_from = none;
        continue;
      }
      if (open.empty() && element.name != "svg")
        elements.refuse_at(element.line, "is not an SVG file: its root is <" + element.name + ">");
      if (!alternatives.empty() && alternatives.back() >= 0 && !is_hidden(element) &&
          element.name != "foreignObject" && ++alternatives.back() > 1)
        elements.refuse_at(element.line, "<switch> has several alternatives: delete all but one");
      if (const auto style = element.attributes.find("style");
          style != element.attributes.end() && style->second.find("transform") != std::string::npos)
        elements.refuse_at(
            element.line,
            "a style transforms a shape, which cannot be read: flatten transforms before saving");
      has_classes_ = has_classes_ || element.attributes.contains("class");
      const glm::dmat3 map = (open.empty() ? glm::dmat3(1.0) : open.back()) *
                             (open.empty() ? glm::dmat3(1.0) : transform_of(elements, element));
      cuts_.push_back(cut_of(element));
      if (open.empty())
        read_root(elements, element);
      else if (hidden_from == none && !is_hidden(element))
        each(elements, element, map);
      if (hidden_from == none && !open.empty() && is_hidden(element)) hidden_from = open.size();
      open.push_back(map);
      alternatives.push_back(element.name == "switch" ? 0 : -1);
    }
  }

  double mm_per_unit() const { return mm_per_unit_; }
  /// Whether the root states its width or height in a unit of length. A pixel does not count as one.
  bool has_length() const { return has_length_; }
  bool is_in_pixels() const { return is_in_pixels_; }
  const PixelLength& pixel() const { return pixel_; }
  /// Whether any element has a class; the style sheet, which is not read, may hide it.
  bool has_classes() const { return has_classes_; }
  /// The clip paths and masks of the current element of walk() and of the groups around it, as cut_of()
  /// describes them.
  std::vector<std::string> cuts() const {
    std::vector<std::string> stated;
    std::copy_if(cuts_.begin(), cuts_.end(), std::back_inserter(stated),
                 [](const std::string& cut) { return !cut.empty(); });
    return stated;
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  static bool is_hidden(const XmlTag& element) {
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
    return says("display", "none") || says("style", "display:none") || says("visibility", "hidden") ||
           says("visibility", "collapse") || says("style", "visibility:hidden");
  }

  void read_root(const XmlTags& elements, const XmlTag& root) {
    mm_per_unit_ = pixel_.mm();
    is_in_pixels_ = has_length_ = false;
    const auto length_mm = [&](const char* key) -> std::optional<double> {
      const auto found = root.attributes.find(key);
      if (found == root.attributes.end() || found->second.ends_with('%')) return std::nullopt;
      const bool is_bare = found->second.find_first_not_of("0123456789+-.eE ") == std::string::npos;
      const bool is_pixels = is_bare || found->second.find("px") != std::string::npos;
      (is_pixels ? is_in_pixels_ : has_length_) = true;
      // A number without a unit is multiplied by 1 here and converted below.
      const double value =
          length_of(elements, root, key, 0.0, is_pixels && !is_bare ? mm_per_css_pixel : 1.0);
      return is_pixels ? value * pixel_.mm() : value;
    };
    const std::optional<double> width_mm = length_mm("width"), height_mm = length_mm("height");
    const std::vector<double> box = numbers_of(elements, root, "viewBox");
    if (box.empty()) return;
    if (box.size() != 4) elements.refuse_at(root.line, "viewBox must have four numbers");
    const glm::dvec2 size(box[2], box[3]);
    if (!(size.x > 0.0 && size.y > 0.0)) elements.refuse_at(root.line, "viewBox has no size");
    if (!width_mm && !height_mm) return;
    const double across = width_mm ? *width_mm / size.x : *height_mm / size.y;
    const double down = height_mm ? *height_mm / size.y : across;
    if (!(across > 0.0) || std::abs(down / across - 1.0) > 1e-3)
      elements.refuse_at(root.line,
                         "width and height differ from viewBox in their ratio, so the length of a unit is "
                         "unknown: make the ratios equal");
    mm_per_unit_ = across;
  }

  PixelLength pixel_;
  XmlTags elements_;
  bool has_length_ = false, is_in_pixels_ = false, has_classes_ = false;
  std::vector<std::string> cuts_;  ///< cut_of() of each open element
  double mm_per_unit_ = mm_per_css_pixel;
};

SvgPicture picture_of(const XmlTags& elements, const XmlTag& element, const glm::dmat3& map, double unit_mm) {
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
    elements.refuse_at(element.line, "<image> has no positive width and height");
  return picture;
}

/// Adds a polygon without repeated neighbouring points. If fewer than three points remain, adds a finding
/// instead.
void add_polygon(std::vector<glm::dvec2> polygon, std::size_t line, SvgOutlines& made) {
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  while (polygon.size() > 1 && glm::distance(polygon.front(), polygon.back()) < 1e-9) polygon.pop_back();
  if (polygon.size() >= 3)
    made.polygons_mm.push_back(std::move(polygon));
  else
    made.findings.push_back("line " + std::to_string(line) +
                            ": an outline with fewer than three points is left out");
}

}  // namespace

SvgOutlines read_svg_outlines(const std::filesystem::path& path, const SvgPlacement& place,
                              double tolerance_mm) {
  voxel::need_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path.string(), "cannot be read");
  if (std::filesystem::file_size(path) > most_bytes)
    refuse(path.string(), "is larger than 256 MB: link its picture instead of embedding it");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  Drawing drawing(path.string(), text);
  SvgOutlines made;
  std::optional<SvgPicture> picture;
  std::map<std::string, int> left_out;
  drawing.walk([&](const XmlTags& elements, const XmlTag& element, const glm::dmat3& map) {
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
  std::vector<std::string> cuts;
  drawing.walk([&](const XmlTags& elements, const XmlTag& element, const glm::dmat3& map) {
    const std::size_t before = made.polygons_mm.size();
    for (std::vector<glm::dvec2>& polygon : polygons_of(elements, element, mm_from_user * map, tolerance_mm))
      add_polygon(std::move(polygon), element.line, made);
    if (made.polygons_mm.size() == before) return;
    for (std::string& cut : drawing.cuts())
      if (std::find(cuts.begin(), cuts.end(), cut) == cuts.end()) cuts.push_back(std::move(cut));
  });
  if (made.polygons_mm.empty())
    refuse(path.string(), "has no outline: draw a path, polygon, polyline, rect, circle or ellipse");
  for (const auto& [name, count] : left_out)
    made.findings.push_back(std::to_string(count) + " <" + name +
                            "> left out, because such elements enclose no area");
  constexpr std::size_t most_told = 8;
  for (std::size_t i = 0; i < std::min(cuts.size(), most_told); ++i)
    made.findings.push_back("WARN: " + cuts[i] +
                            " is not applied: the outlines there are used whole, including parts that the "
                            "drawing hides; cut the shapes, or release the clip or mask");
  if (cuts.size() > most_told)
    made.findings.push_back("WARN: " + std::to_string(cuts.size() - most_told) +
                            " more clip paths and masks are not applied");
  if (drawing.has_classes())
    made.findings.push_back(
        "its style sheet is not applied: outlines of classes that it hides, clips or masks are used whole; "
        "delete hidden layers");
  if (!picture && !drawing.has_length())
    made.findings.push_back(
        (drawing.is_in_pixels() ? "the drawing states its width in pixels, whose length is assumed: a pixel"
                                : "the drawing states no width in millimetres: a unit") +
        std::string(" is taken as 1/") + std::to_string(drawing.pixel().per_inch) + " inch, " +
        three_figures(drawing.pixel().mm()) + " mm, " +
        (drawing.pixel().program.empty() ? "as CSS has it" : "as " + drawing.pixel().program + " has it") +
        "; give the root a width in mm");
  return made;
}

}  // namespace octotomy::planner
