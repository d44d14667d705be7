// SPDX-License-Identifier: AGPL-3.0-or-later

#include "brep/boolean/boolean.h"
#include "brep/io/write_mesh.h"
#include "brep/measure/difference.h"
#include "brep/mesh/error.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/measure/result_json.h"
#include "planner/report/distance_histogram.h"
#include "planner/table/number_format.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner::cli {
namespace {

struct CompareText {
  std::filesystem::path a, b, out, picture;
  std::optional<double> colour_range_mm;
  bool no_dice = false;
  brep::DifferenceOptions options;
};

Json to_json(const brep::OneWay& way, const std::vector<double>& tolerances) {
  Json bands = Json::array();
  for (std::size_t k = 0; k < tolerances.size(); ++k)
    bands.push_back({{"tolerance_mm", tolerances[k]}, {"share_within", way.within[k]}});
  return {{"mean_mm", way.mean_mm},
          {"rms_mm", way.rms_mm},
          {"p95_mm", way.p95_mm},
          {"max_mm", way.max_mm},
          {"signed_mean_mm", way.signed_mean_mm},
          {"bands", bands}};
}

/// Twice the common volume by the sum of both; none with a finding where there is no such volume.
std::optional<double> dice(const brep::Mesh& a, const brep::Mesh& b, const std::stop_token& stop,
                           std::vector<std::string>& findings) {
  std::string doing;
  const auto solid = [&](const brep::Mesh& mesh, const char* name) {
    doing = std::string(name) + " ";
    return brep::solid_of(mesh);
  };
  try {
    const brep::Solid solid_a = solid(a, "A"), solid_b = solid(b, "B");
    doing.clear();
    const brep::BooleanResult common = brep::boolean(solid_a, brep::Operation::Intersection, solid_b, stop);
    findings.insert(findings.end(), common.findings.begin(), common.findings.end());
    return 2.0 * brep::volume_mm3(common.solid) / (brep::volume_mm3(solid_a) + brep::volume_mm3(solid_b));
  } catch (const brep::Error& error) {
    if (error.code() != brep::ErrorCode::Geometry) throw;
    findings.push_back("no Dice: " + doing + error.what());
    return std::nullopt;
  }
}

void write_coloured(const CompareText& text, const brep::Mesh& a, const brep::Difference& difference,
                    double range_mm) {
  brep::VertexData data;
  for (const double distance : difference.vertex_mm)
    data.colours.push_back(distance_colour(distance, range_mm));
  if (text.out.extension() != ".glb") {
    data.scalar_name = "distance_mm";
    data.scalars = difference.vertex_mm;
  }
  brep::write_mesh(a, text.out, data);
}

Json definition(const brep::Difference& difference) {
  return {
      {"hausdorff_mm", "largest distance of a point of either surface to the other's nearest triangle, at " +
                           std::to_string(difference.sample_count) + " samples and all vertices"},
      {"hausdorff95_mm", "larger of the two directed, area-weighted 95th percentiles, point to triangle"},
      {"mean_mm", "area-weighted mean of absolute distances, point to triangle, over both surfaces"},
      {"signed", "positive where A lies outside B (a_to_b), or B outside A (b_to_a)"},
      {"dice", "twice the intersection's volume by the sum of both volumes, by mesh Boolean"}};
}

int compare(const Program& program, const CompareText& text) {
  if (!text.out.empty()) {
    const auto extension = text.out.extension();
    if (extension != ".ply" && extension != ".vtp" && extension != ".glb")
      throw std::runtime_error(text.out.string() + ": the coloured mesh is written as .ply, .vtp or .glb");
    need_folder_of(text.out);
  }
  if (!text.picture.empty()) {
    if (text.picture.extension() != ".png")
      throw std::runtime_error(text.picture.string() + ": the histogram is drawn as .png");
    need_folder_of(text.picture);
  }
  Timings timings;
  const brep::Mesh a = read_surface(text.a, timings), b = read_surface(text.b, timings);
  brep::Difference difference;
  {
    const Stopwatch watch(timings, "distances");
    difference = brep::difference(a, b, text.options);
  }
  std::vector<std::string> findings;
  std::optional<double> overlap;
  if (!text.no_dice) {
    const Stopwatch watch(timings, "dice");
    overlap = dice(a, b, program.stop.get_token(), findings);
  }
  if (difference.on_border_count > 0)
    findings.push_back(std::to_string(difference.on_border_count) + " of " +
                       std::to_string(difference.sample_count) +
                       " samples are nearest to a border, where the sign is a guess");
  const double range_mm = text.colour_range_mm.value_or(difference.hausdorff95_mm);
  if (!text.out.empty()) {
    const Stopwatch watch(timings, "write");
    write_coloured(text, a, difference, range_mm);
  }
  if (!text.picture.empty()) {
    const Stopwatch watch(timings, "picture");
    const HistogramPicture picture = draw_histogram(difference, range_mm);
    voxel::write_image(text.picture, picture.size_px, picture.rgb);
  }
  for (const std::string& finding : findings) warn(finding);

  Json json = answer(timings);
  json["hausdorff_mm"] = difference.hausdorff_mm;
  json["hausdorff95_mm"] = difference.hausdorff95_mm;
  json["mean_mm"] = difference.mean_mm;
  json["rms_mm"] = difference.rms_mm;
  json["dice"] = overlap ? Json(*overlap) : Json(nullptr);
  json["definition"] = definition(difference);
  json["a_to_b"] = to_json(difference.a_to_b, text.options.tolerances_mm);
  json["b_to_a"] = to_json(difference.b_to_a, text.options.tolerances_mm);
  json["hausdorff_short_by_mm"] = difference.hausdorff_short_by_mm;
  json["samples"] = difference.sample_count;
  json["histogram"] = {{"low_mm", difference.histogram.low_mm},
                       {"width_mm", difference.histogram.width_mm},
                       {"shares", difference.histogram.shares}};
  json["path"] = text.out.empty() ? Json(nullptr) : Json(text.out.string());
  json["picture"] = text.picture.empty() ? Json(nullptr) : Json(text.picture.string());
  json["colour_range_mm"] = text.out.empty() && text.picture.empty() ? Json(nullptr) : Json(range_mm);
  json["findings"] = findings;
  program.say(json, lines({{"mean", grouped(difference.mean_mm, 3) + " mm"},
                           {"Hausdorff 95", grouped(difference.hausdorff95_mm, 3) + " mm"},
                           {"Hausdorff", grouped(difference.hausdorff_mm, 3) + " mm"},
                           {"Dice", overlap ? grouped(*overlap, 5) : "none"}}));
  return done;
}

}  // namespace

void add_compare(Program& program) {
  const auto text = std::make_shared<CompareText>();
  CLI::App& verb =
      program.verb("compare", "How far two surfaces lie apart, both ways",
                   "octotomy compare planned.stl after.stl -o difference.ply --picture difference.png --json",
                   [&program, text] { return compare(program, *text); });
  verb.add_option("a", text->a, "A mesh")->required()->check(CLI::ExistingFile);
  verb.add_option("b", text->b, "A mesh in the same frame")->required()->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out,
                  "A coloured by its distance to B, red outside, blue inside: a .ply, .vtp or .glb file");
  verb.add_option("--picture", text->picture, "The histogram of distances in those colours: a .png file");
  verb.add_option("--range", text->colour_range_mm,
                  "Distance of full colour, mm; the Hausdorff 95 if not given")
      ->check(above_zero());
  verb.add_option("--tolerances", text->options.tolerances_mm, "Bands whose share of the area is told, mm")
      ->capture_default_str();
  verb.add_option("--spacing", text->options.spacing_mm, "Of the samples, mm; 200 000 a surface if not given")
      ->check(above_zero());
  verb.add_option("--bins", text->options.bins, "Of the histogram")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb.add_flag("--no-dice", text->no_dice, "Leave out the common volume, the dearest part for large meshes");
}

}  // namespace octotomy::planner::cli
