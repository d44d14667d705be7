// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/drawn_region.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "planner/operation/file/contour_findings.h"
#include "planner/operation/file/picture_frame.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/file/slicer_markup.h"
#include "planner/operation/file/svg_outlines.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "voxel/solid/polygon.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using Polygon = std::vector<glm::dvec2>;

DrawnRegion drawn_in(const voxel::View& view, std::vector<Polygon> polygons_mm) {
  for (Polygon& polygon : polygons_mm)
    for (glm::dvec2& point : polygon) point = glm::round(1e4 * point) / 1e4 + 0.0;
  return {name_of(view), {view, std::move(polygons_mm)}, {}};
}

std::string decoded_base64(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto digit = digits.find(letter);
    if (digit == std::string_view::npos) continue;  // blanks, line ends, padding
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

/// "%20" in a link.
std::string unescaped(const std::string& link) {
  std::string path;
  for (std::size_t i = 0; i < link.size(); ++i)
    if (link[i] == '%' && i + 2 < link.size() && std::isxdigit(static_cast<unsigned char>(link[i + 1])) &&
        std::isxdigit(static_cast<unsigned char>(link[i + 2]))) {
      path += static_cast<char>(std::stoi(link.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      path += link[i];
    }
  return path.starts_with("file://") ? path.substr(7) : path;
}

PictureFrame frame_of_drawing(const SvgPicture& picture, const fs::path& drawing) {
  const std::string where = drawing.string() + ", line " + std::to_string(picture.line) + ": its <image>";
  if (const std::string data = "data:image/png;base64,"; picture.link.starts_with(data))
    return read_frame(decoded_base64(std::string_view(picture.link).substr(data.size())), where);
  if (picture.link.starts_with("data:") || voxel::extension_of(unescaped(picture.link)) != ".png")
    refuse(where,
           "is not a .png: only a .png of octotomy render or slice states the positions of its pixels");
  const fs::path path = drawing.parent_path() / unescaped(picture.link);
  if (!fs::exists(path))
    refuse(where,
           "links to " + path.string() + ", which does not exist: move the picture there, or embed it");
  return read_frame(path);
}

/// Maps the drawing's user units to positions in the picture, in pixels from its top left corner.
glm::dmat3 pixel_from_user(const SvgPicture& picture, const glm::ivec2& size_px) {
  glm::dvec2 units_per_pixel = picture.shown_units / glm::dvec2(size_px), first(0.0);
  if (picture.keeps_aspect) {
    units_per_pixel = glm::dvec2(std::min(units_per_pixel.x, units_per_pixel.y));
    first = 0.5 * (picture.shown_units - units_per_pixel * glm::dvec2(size_px));
  }
  const glm::dmat3 shown_from_pixel({units_per_pixel.x, 0, 0}, {0, units_per_pixel.y, 0}, {first, 1});
  return glm::inverse(picture.user_from_shown * shown_from_pixel);
}

/// The number of polygons that are holes: their first point lies within an odd number of other polygons.
std::size_t holes_among(const std::vector<Polygon>& polygons) {
  std::size_t holes = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    std::vector<Polygon> others = polygons;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    holes += voxel::contains(others, polygons[i].front()) ? 1 : 0;
  }
  return holes;
}

DrawnRegion of_svg(const std::optional<voxel::View>& view, const fs::path& path) {
  std::optional<voxel::View> seen = view;
  const SvgOutlines found = read_svg_outlines(
      path,
      [&](double mm_per_unit, const std::optional<SvgPicture>& picture) {
        if (!view && !picture)
          refuse(path.string(),
                 "holds no picture: name the view in which the region is drawn, for example anterior:" +
                     path.filename().string() + ", or draw over a .png of octotomy render");
        if (view) return glm::dmat3({mm_per_unit, 0, 0}, {0, -mm_per_unit, 0}, {0, 0, 1});
        const PictureFrame frame = frame_of_drawing(*picture, path);
        seen = frame.view();
        // A picture's frame counts from the centre of the first pixel, a drawing from its corner.
        const glm::dmat3 centres({1, 0, 0}, {0, 1, 0}, {-0.5, -0.5, 1});
        return frame.view_mm_from_pixel() * centres * pixel_from_user(*picture, frame.size_px);
      },
      curve_tolerance_mm);
  DrawnRegion made = drawn_in(*seen, found.polygons_mm);
  for (const std::string& finding : found.findings)
    made.findings.push_back(path.filename().string() + ": " + finding);
  if (const std::size_t holes = holes_among(made.region.polygons_mm); holes > 0)
    made.findings.push_back(path.filename().string() + ": " + std::to_string(holes) +
                            (holes == 1 ? " outline lies" : " outlines lie") +
                            " within another and counts as a hole, even if the drawing fills it");
  return made;
}

DrawnRegion of_markups(const voxel::View& view, const fs::path& path) {
  std::vector<std::string> findings;
  DrawnRegion made = drawn_in(view, read_closed_curves(path, view.right, view.up, findings));
  made.findings = std::move(findings);
  return made;
}

/// Throws std::runtime_error unless the polygons form a region.
void check_drawn(const DrawnRegion& drawn, const std::string& where) {
  try {
    voxel::check(voxel::RegionMask{{drawn.region}});
  } catch (const voxel::InvalidInput& error) {
    refuse(where, error.what());
  }
}

}  // namespace

DrawnRegion read_drawn_region(const std::string& text) {
  const auto colon = text.find(':');
  if (voxel::extension_of(text) == ".svgz")
    refuse("--region",
           "'" + text +
               "' is a compressed SVG drawing, which cannot be read: save it as plain .svg, or unpack "
               "it by 'gunzip -S .svgz'");
  const bool is_drawing = voxel::extension_of(text) == ".svg";
  std::optional<voxel::View> view;
  fs::path path = text;
  if (colon != std::string::npos && colon > 0 && colon + 1 < text.size()) {
    path = text.substr(colon + 1);
    try {
      view = voxel::parse_view(text.substr(0, colon));
    } catch (const voxel::InvalidInput& error) {
      refuse("--region", error.what());
    }
  } else if (!is_drawing) {
    refuse("--region", "'" + text + "' is not a region: write VIEW:FILE, for example anterior:cut.json");
  }
  DrawnRegion drawn;
  if (is_drawing)
    drawn = of_svg(view, path);
  else if (voxel::lower_case(path.string()).ends_with(".mrk.json"))
    drawn = of_markups(*view, path);
  else
    drawn = {name_of(*view), read_region(*view, path), {}};
  check_drawn(drawn, path.string());
  for (const std::string& finding : findings_of(drawn.region))
    drawn.findings.push_back(path.filename().string() + ": " + finding);
  return drawn;
}

DrawnRegion region_of_pixels(const std::string& text) {
  const std::string option = "--region-pixels";
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0)
    refuse(option, "'" + text +
                       "' is not a region: write PICTURE.png:X,Y X,Y X,Y, for example \"front.png:120,80 "
                       "300,80 300,200\"");
  const fs::path path = text.substr(0, colon);
  if (!fs::exists(path)) refuse(option, path.string() + ": there is no such file");
  const PictureFrame frame = read_frame(path);
  const glm::dmat3 mm_from_pixel = frame.view_mm_from_pixel();
  std::vector<Polygon> polygons;
  std::istringstream lines(text.substr(colon + 1));
  for (std::string line; std::getline(lines, line, ';');) {
    polygons.emplace_back();
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const std::vector<double> pixel = comma_numbers(word);
      if (pixel.size() != 2) refuse(option, "'" + word + "' is no pixel X,Y");
      const double x = pixel[0], y = pixel[1];
      if (!(x >= -0.5 && y >= -0.5 && x <= frame.size_px.x - 0.5 && y <= frame.size_px.y - 0.5))
        refuse(option, "'" + word + "' lies outside of " + path.string() + ", which has " +
                           std::to_string(frame.size_px.x) + " x " + std::to_string(frame.size_px.y));
      polygons.back().emplace_back(mm_from_pixel * glm::dvec3(x, y, 1.0));
    }
  }
  DrawnRegion made = drawn_in(frame.view(), std::move(polygons));
  check_drawn(made, option);
  return made;
}

}  // namespace octotomy::planner
