// SPDX-License-Identifier: AGPL-3.0-or-later
// The distances between two objects' surfaces, in both directions, and their common volume.
#include "brep/io/write_mesh.h"
#include "brep/measure/difference.h"
#include "brep/mesh/line_volume.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/measure/compare_labels.h"
#include "planner/operation/measure/distance_histogram.h"
#include "planner/operation/measure/face_difference.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

struct Compare {
  ObjectName a, b;
  std::vector<double> tolerances_mm = brep::DifferenceOptions{}.tolerances_mm;
  std::optional<double> spacing_mm;
  int bins = static_cast<int>(brep::DifferenceOptions{}.bins);
  bool no_dice = false;
  // Only the verb has the following options.
  std::filesystem::path out, picture;
  std::optional<double> range_mm;
  bool other_identity = false;
};

Json one_way_json(const brep::OneWay& way, const std::vector<double>& tolerances) {
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

/// The Dice coefficient: twice the common volume divided by the sum of both volumes.
struct Dice {
  double value = 0.0, half_width = 0.0;
  std::size_t lines = 0;
};

/// Lines through holes of a surface are left out. If they are more than this share, the surface has no
/// defined inside.
constexpr double most_open_lines() {
  return 0.01;
}

/// The Dice coefficient of two surfaces. None, with a finding, if they have no defined inside.
std::optional<Dice> dice(const brep::Triangles& a, const brep::Triangles& b,
                         std::vector<std::string>& findings) {
  const brep::LineVolumes volumes = brep::line_volumes(a, b);
  const auto of = [](const brep::LineVolume& v) { return 2.0 * v.common_mm3 / (v.a_mm3 + v.b_mm3); };
  const double open =
      volumes.lines == 0 ? 1.0 : static_cast<double>(volumes.open_lines) / static_cast<double>(volumes.lines);
  const auto& [even, odd] = volumes.halves;
  if (open > most_open_lines() || !(even.a_mm3 + even.b_mm3 > 0.0) || !(odd.a_mm3 + odd.b_mm3 > 0.0)) {
    findings.push_back("no Dice: " + three_figures(100.0 * open) +
                       " % of the lines through the surfaces pass holes or triangles that face the wrong "
                       "way, or the surfaces enclose nothing: mend them by octotomy repair");
    return std::nullopt;
  }
  if (volumes.open_lines > 0)
    findings.push_back("Dice leaves out " + three_figures(100.0 * open) +
                       " % of the lines, because these pass holes or triangles that face the wrong way");
  return Dice{of(volumes.all), std::abs(of(even) - of(odd)), volumes.lines};
}

Json definitions(const brep::Difference& difference, const std::optional<Dice>& dice) {
  return {
      {"hausdorff_mm",
       "largest distance from a point of either surface to the nearest triangle of the other surface, at " +
           std::to_string(difference.sample_count) + " samples and all vertices"},
      {"hausdorff95_mm", "larger of the two directed, area-weighted 95th percentiles, point to triangle"},
      {"mean_mm", "area-weighted mean of absolute distances, point to triangle, over both surfaces"},
      {"signed", "positive where A lies outside B (a_to_b), or B outside A (b_to_a)"},
      {"dice", "twice the common volume divided by the sum of both volumes, from lengths along " +
                   std::to_string(dice ? dice->lines : 0) + " parallel lines"}};
}

/// The results of comparing two surfaces.
struct Compared {
  brep::Difference difference;
  std::optional<Dice> dice;
  std::vector<std::string> findings;
};

Compared compared(const Compare& asked, const brep::Linked& a, const brep::Linked& b, Timings& timings) {
  Compared made;
  {
    const Stopwatch watch(timings, "distances");
    brep::DifferenceOptions options;
    options.tolerances_mm = asked.tolerances_mm;
    options.spacing_mm = asked.spacing_mm;
    options.bins = static_cast<decltype(options.bins)>(asked.bins);
    made.difference = brep::difference(a, b, options);
  }
  if (!asked.no_dice) {
    const Stopwatch watch(timings, "dice");
    made.dice = dice(a.triangles, b.triangles, made.findings);
  }
  if (made.difference.on_border_count > 0)
    made.findings.push_back(
        "the sign of the distance is a guess at samples that are nearest to a border of the other surface: " +
        std::to_string(made.difference.on_border_count) + " of " +
        std::to_string(made.difference.sample_count) + " samples");
  return made;
}

Json comparison_json(const Compare& asked, const Compared& made) {
  const brep::Difference& difference = made.difference;
  return {{"hausdorff_mm", difference.hausdorff_mm},
          {"hausdorff95_mm", difference.hausdorff95_mm},
          {"mean_mm", difference.mean_mm},
          {"rms_mm", difference.rms_mm},
          {"dice", made.dice ? Json(made.dice->value) : Json(nullptr)},
          {"dice_half_width", made.dice ? Json(made.dice->half_width) : Json(nullptr)},
          {"definition", definitions(difference, made.dice)},
          {"a_to_b", one_way_json(difference.a_to_b, asked.tolerances_mm)},
          {"b_to_a", one_way_json(difference.b_to_a, asked.tolerances_mm)},
          {"hausdorff_short_by_mm", difference.hausdorff_short_by_mm},
          {"samples", difference.sample_count},
          {"histogram",
           {{"low_mm", difference.histogram.low_mm},
            {"width_mm", difference.histogram.width_mm},
            {"shares", difference.histogram.shares}}}};
}

/// The distances between the meshes of two objects as JSON. Null, with a finding, if one of them has no mesh
/// or is empty.
Json measure(const Compare& asked, const AnswerBench& bench) {
  Json json{{"a", asked.a.name}, {"b", asked.b.name}};
  for (const ObjectName& name : {asked.a, asked.b}) {
    const std::optional<brep::Solid>& mesh = bench.objects.at(name.name).mesh.within;
    if (mesh && !mesh->empty()) continue;
    json.update({{"mean_mm", nullptr},
                 {"findings", Json::array({"'" + name.name +
                                           (mesh ? "' is empty" : "' has no mesh, see its findings")})}});
    return json;
  }
  const Compared made = compared(asked, bench.objects.at(asked.a.name).mesh.within->linked(),
                                 bench.objects.at(asked.b.name).mesh.within->linked(), bench.timings);
  json.update(comparison_json(asked, made));
  if (const auto face =
          face_difference(bench.objects.at(asked.a.name), bench.objects.at(asked.b.name), bench.objects))
    json["face"] = print_record(*face);
  json.update({{"findings", made.findings}});
  return json;
}

void write_coloured(const std::filesystem::path& out, const brep::Triangles& a,
                    const brep::Difference& difference, double range_mm, Timings& timings) {
  brep::VertexData data;
  for (const double distance : difference.vertex_mm)
    data.colours.push_back(distance_colour(distance, range_mm));
  if (voxel::extension_of(out) != ".glb") {
    data.scalar_name = "distance_mm";
    data.scalars = difference.vertex_mm;
  }
  write_surface(a, out, timings, data);
}

void write_pictures(const Compare& asked, const brep::Triangles& a, const brep::Difference& difference,
                    double range_mm, Timings& timings) {
  Outputs outputs;
  if (!asked.out.empty())
    outputs.write(asked.out, [&](const std::filesystem::path& file) {
      write_coloured(file, a, difference, range_mm, timings);
    });
  if (!asked.picture.empty()) {
    const Stopwatch watch(timings, "picture");
    const HistogramPicture picture = draw_histogram(difference, range_mm);
    outputs.write(asked.picture, [&](const std::filesystem::path& file) {
      voxel::write_image(file, picture.size_px, picture.rgb);
    });
  }
  outputs.commit();
}

FileAnswer on_files(const Compare& asked, const FileBench& bench) {
  if (is_label_map(asked.a.name) != is_label_map(asked.b.name))
    throw std::runtime_error("one of " + asked.a.name + " and " + asked.b.name +
                             " is a label map and the other file a surface: make surfaces of the labels "
                             "first, by octotomy surfaces");
  if (is_label_map(asked.a.name)) {
    if (!asked.out.empty() || !asked.picture.empty())
      throw std::runtime_error("--out and --picture apply only to surfaces: leave them out for label maps");
    return compare_label_maps(asked.a.name, asked.b.name, asked.other_identity, bench);
  }
  if (!asked.out.empty()) need_extension(asked.out, {".ply", ".vtp", ".glb"}, "the coloured mesh is");
  if (!asked.picture.empty()) need_extension(asked.picture, {".png"}, "the histogram is");
  need_outputs({asked.out, asked.picture}, {asked.a.name, asked.b.name});
  std::vector<std::string> joined;
  const auto [a, b] = read_surfaces({asked.a.name, asked.b.name}, bench.timings, joined);
  Compared made = compared(asked, a, b, bench.timings);
  made.findings.insert(made.findings.begin(), joined.begin(), joined.end());
  const double range_mm = asked.range_mm.value_or(made.difference.hausdorff95_mm);
  write_pictures(asked, a.triangles, made.difference, range_mm, bench.timings);
  FileAnswer answer{comparison_json(asked, made)};
  answer.findings = made.findings;
  answer.json.update(
      {{"path", asked.out.empty() ? Json(nullptr) : Json(asked.out.string())},
       {"picture", asked.picture.empty() ? Json(nullptr) : Json(asked.picture.string())},
       {"colour_range_mm", asked.out.empty() && asked.picture.empty() ? Json(nullptr) : Json(range_mm)},
       {"findings", made.findings}});
  answer.rows = {{"mean", grouped(made.difference.mean_mm, 3) + " mm"},
                 {"Hausdorff 95", grouped(made.difference.hausdorff95_mm, 3) + " mm"},
                 {"Hausdorff", grouped(made.difference.hausdorff_mm, 3) + " mm"},
                 {"Dice", made.dice ? grouped(made.dice->value, 5) : "none"}};
  return answer;
}

}  // namespace

Operation compare_operation() {
  return Describe<Compare>("compare",
                           "Measures the distances between two surfaces, from each one to the other.",
                           Makes::Measurement)
      .takes(field("a", &Compare::a, "An object.").required().positional("a"))
      .takes(field("b", &Compare::b, "Another object or file in the same frame.").required().positional("b"))
      .takes(field(
          "tolerances_mm", &Compare::tolerances_mm,
          "Distances in mm. For each, the share of the area that lies within this distance is reported."))
      .takes(field("spacing_mm", &Compare::spacing_mm,
                   "Distance between samples on the surfaces. Default: so that each surface has about 200 "
                   "000 samples.")
                 .greater_than(0.0))
      .takes(field("bins", &Compare::bins, "Number of bins in the histogram of signed distances.")
                 .from(1)
                 .to(10000))
      .takes(
          field("no_dice", &Compare::no_dice, "Omits the Dice coefficient, which needs the common volume."))
      .verb_takes(field(
          "out", &Compare::out,
          "A file of A coloured by its distance to B, red outside and blue inside: .ply, .vtp or .glb."))
      .verb_takes(field("picture", &Compare::picture,
                        "A .png file of the histogram of signed distances, in the same colours."))
      .verb_takes(field("range_mm", &Compare::range_mm,
                        "Distance from which on the colour is saturated. Default: the Hausdorff 95.")
                      .greater_than(0.0))
      .verb_takes(field("other_identity", &Compare::other_identity,
                        "Compares segmentations even if they state different patients, studies or frames of "
                        "reference; a finding then begins with FAIL."))
      .example(
          R"({"id": "apart", "do": "compare", "a": "maxilla", "b": "advanced", "tolerances_mm": [1, 2]})")
      .on_files(
          "octotomy compare planned.stl after.stl -o difference.ply --picture difference.png --json\n"
          "  octotomy compare mine.nii.gz theirs.nii.gz --json      # two label maps, label by label",
          on_files)
      .measure(measure);
}

}  // namespace octotomy::planner
