// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/ray_choice.h"

#include <algorithm>
#include <array>

#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/ray_pictures.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// The pieces between colons.
std::vector<std::string> pieces_of(const std::string& text) {
  std::vector<std::string> pieces(1);
  for (const char letter : text)
    if (letter == ':')
      pieces.emplace_back();
    else
      pieces.back() += letter;
  return pieces;
}

/// The range LOW:HIGH in the first two parts of a text; none if they are not a range.
std::optional<std::array<double, 2>> range_of(const std::vector<std::string>& pieces) {
  if (pieces.size() < 2) return std::nullopt;
  const std::optional<double> low = number_in(pieces[0]), high = number_in(pieces[1]);
  if (!low || !high || !(*low <= *high)) return std::nullopt;
  return std::array<double, 2>{*low, *high};
}

voxel::RangeWeight weight_of(const std::string& text) {
  const std::vector<std::string> pieces = pieces_of(text);
  const auto range = range_of(pieces);
  const std::optional<double> weight = pieces.size() == 3 ? number_in(pieces[2]) : 0.0;
  if (!range || pieces.size() > 3 || !weight || *weight < 0.0 || *weight > voxel::RangeWeight::max_weight)
    throw std::runtime_error(
        "--dissolve: '" + text +
        "' is not a range: write LOW:HIGH, or LOW:HIGH:SHARE with a share from 0 to 100");
  return {(*range)[0], (*range)[1], *weight};
}

voxel::DensityColour density_colour_of(const std::string& text) {
  const std::vector<std::string> pieces = pieces_of(text);
  const auto range = range_of(pieces);
  const auto colour = pieces.size() == 3 ? colour_of_text(pieces[2]) : std::nullopt;
  if (!range || !colour)
    throw std::runtime_error(
        "--density-colour: '" + text +
        "' is not a coloured range: write LOW:HIGH:#RRGGBB, for example 300:700:#cc7a29");
  return {(*range)[0], (*range)[1], *colour};
}

bool decides_by_change(const Render& render) {
  return render.decide == "derivative" || render.decide == "gradient";
}

bool shows_surface_colours(const Render& render) {
  static const std::vector<std::string> painted{"gradient", "context", "partial_volume", "grey_gradient",
                                                "density"};
  return !render.relief && std::find(painted.begin(), painted.end(), render.shading) != painted.end();
}

/// Refuses options that have no effect on a relief, because it is drawn in black lines on white.
void check_relief(const Render& render) {
  if (!render.colours.empty() || !render.opacities.empty() || !render.colour_by.empty() || render.annotate ||
      render.grid_mm || render.stereo_deg || render.cut_face != "plain")
    throw std::runtime_error(
        "--relief is drawn in black lines only: leave out --colour, --opacity, --colour-by, --annotate, "
        "--grid, --stereo and --cut-face");
}

}  // namespace

std::vector<Field> ray_fields() {
  std::vector<Field> fields;
  fields.push_back(field("decide", &Render::decide,
                         "Where a ray through the samples of one scan or grey octree ends: range (at a "
                         "sample in the window), derivative (where samples rise along the ray by at least "
                         "steeper_per_mm) or gradient (where they change by at least steeper_per_mm in any "
                         "direction). Default: at the objects' surfaces.")
                       .one_of({"range", "derivative", "gradient"})
                       .read_if<Render>([](const Render& render) { return !is_ray_picture(render); },
                                        "applies only to pictures of surfaces: choose another 'shading'"));
  fields.push_back(
      field("steeper_per_mm", &Render::steeper_per_mm,
            "Change of samples, in their unit per mm, above which rays end.")
          .greater_than(0.0)
          .called("steeper")
          .read_if<Render>(decides_by_change,
                           "applies only to 'decide' derivative or gradient: choose one of them"));
  fields.push_back(
      field("peel", &Render::peel,
            "Number of layers that are removed. A layer is a stretch of the ray on which the condition of "
            "'decide' (default: range) holds; the picture shows the surface behind these layers.")
          .from(1)
          .to(1000)
          .read_if<Render>([](const Render& render) { return !is_ray_picture(render); },
                           "applies only to pictures of surfaces: choose another 'shading'"));
  fields.push_back(field("dissolve", &Render::dissolve,
                         "LOW:HIGH or LOW:HIGH:SHARE in sample units: multiplies the attenuation of the "
                         "samples in a range by SHARE, from 0 (default; dissolved) to 100 (heightened); may "
                         "be repeated. The first range that contains a sample applies.")
                       .repeated()
                       .read_if<Render>([](const Render& render) { return render.shading == "radiograph"; },
                                        "applies only to radiographs: add 'shading' radiograph"));
  fields.push_back(
      field("gradient_opacity", &Render::gradient_opacity,
            "CLEAR:OPAQUE in sample units per mm, for composite pictures: places where samples change by "
            "CLEAR or less are transparent, and places where they change by OPAQUE or more have the transfer "
            "function's opacity. Default: opacity depends on the samples only.")
          .read_if<Render>([](const Render& render) { return render.shading == "composite"; },
                           "applies only to composite pictures: add 'shading' composite"));
  fields.push_back(
      field("density_colours", &Render::density_colours,
            "LOW:HIGH:#RRGGBB in sample units: the colour of visible voxels whose samples lie in a range; "
            "may be repeated. The first range that contains a sample applies.")
          .repeated()
          .called("density-colour")
          .read_if<Render>(
              shows_surface_colours,
              "applies only to coloured surfaces: choose another 'shading', and leave out 'relief'")
          .read_if<Render>([](const Render& render) { return render.colour_by.empty(); },
                           "and 'colour_by' colour the same surface: leave out one of them"));
  return fields;
}

void check_ray_choices(const Render& render) {
  weights_of(render);
  gradient_opacity_of(render);
  density_colours_of(render);
  if (decides_by_change(render) && !render.steeper_per_mm)
    throw std::runtime_error("--decide: " + render.decide +
                             " needs --steeper, the change of samples per mm above which rays end");
  if (render.relief) check_relief(render);
  if (!is_decided(render)) return;
  const auto refuse = [](const std::string& option) {
    throw std::runtime_error(option + ": has no effect with --decide or --peel: leave it out");
  };
  if (!render.algorithm.empty()) refuse("--algorithm");
  if (render.count) refuse("--count");
  if (!render.opacities.empty()) refuse("--opacity");
  if (!render.colour_by.empty()) refuse("--colour-by");
  if (render.cut_face != "plain") refuse("--cut-face");
  if (!render.expression.empty()) refuse("--expression");
  if (shows_densities(render)) refuse(render.shading == "density" ? "--shading density" : "--density-colour");
  if (render.shading == "context" || render.shading == "gradient") refuse("--shading " + render.shading);
}

bool is_decided(const Render& render) {
  return !render.decide.empty() || render.peel;
}

bool shows_densities(const Render& render) {
  return render.shading == "density" || !render.density_colours.empty();
}

voxel::Decision decision_of(const Render& render, double low, double high) {
  voxel::Decision decision;
  decision.low = low;
  decision.high = high;
  decision.peeled = render.peel.value_or(0);
  if (!decides_by_change(render)) return decision;
  decision.by = render.decide == "gradient" ? voxel::Criterion::Gradient : voxel::Criterion::Derivative;
  decision.steeper_per_mm = *render.steeper_per_mm;
  return decision;
}

std::vector<voxel::RangeWeight> weights_of(const Render& render) {
  std::vector<voxel::RangeWeight> weights;
  for (const std::string& text : render.dissolve) weights.push_back(weight_of(text));
  return weights;
}

std::optional<voxel::GradientOpacity> gradient_opacity_of(const Render& render) {
  if (render.gradient_opacity.empty()) return std::nullopt;
  const std::vector<std::string> pieces = pieces_of(render.gradient_opacity);
  const auto range = range_of(pieces);
  if (!range || pieces.size() != 2 || (*range)[0] < 0.0 || !((*range)[1] > (*range)[0]))
    throw std::runtime_error(
        "--gradient-opacity: '" + render.gradient_opacity +
        "' is not a ramp: write CLEAR:OPAQUE, for example 20:200, with 0 <= CLEAR < OPAQUE");
  return voxel::GradientOpacity{(*range)[0], (*range)[1]};
}

std::vector<voxel::DensityColour> density_colours_of(const Render& render) {
  std::vector<voxel::DensityColour> colours;
  for (const std::string& text : render.density_colours) colours.push_back(density_colour_of(text));
  return colours;
}

}  // namespace octotomy::planner
