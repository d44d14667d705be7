// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/report_page.h"

#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/mask.h"
#include "planner/operation/picture/colour.h"
#include "planner/result/report/drawn_page.h"
#include "planner/result/report/patient.h"
#include "voxel/view/surface_scalar.h"

namespace octotomy::planner {
namespace {

Json pair_json(const glm::dvec2& p) {
  return {p.x, p.y};
}

/// The outlines of those mask regions of the plan that belong to the view of this picture. The picture is in
/// the head's orientation.
Json outlines(const Plan& plan, const ScenePicture& picture) {
  Json polygons = Json::array();
  for (const Step& step : plan.steps)
    if (const auto* typed = step.action.get_if<Mask>()) {
      const Mask mask = with_files_read(*typed, plan.folder, plan.lps_from_head.value_or(glm::dmat3(1.0)));
      for (const Mask::Region& region : mask.regions) {
        if (region.view != picture.view || (mask.views_of == "scan" && plan.lps_from_head)) continue;
        for (const auto& polygon : region.polygons_mm) {
          Json& points = polygons.emplace_back(Json::array());
          for (const glm::dvec2& p_mm : polygon) points.push_back(pair_json(p_mm));
        }
      }
    }
  return polygons;
}

Json picture_json(const Plan& plan, const ScenePicture& picture) {
  return {{"view", picture.view},
          {"right", to_json(picture.axes.right)},
          {"up", to_json(picture.axes.up)},
          {"centre_mm", pair_json(picture.centre_mm)},
          {"width_mm", picture.width_mm},
          {"size_px", picture.size_px},
          {"outlines_mm", outlines(plan, picture)},
          {"png", base64(picture.png)}};
}

Json group_json(const Plan& plan, const PictureGroup& group) {
  Json objects = Json::array(), pictures = Json::array(), marks = Json::array();
  for (const voxel::DrawnObject& object : group.objects)
    objects.push_back({{"name", object.name}, {"colour", text_of_colour(object.colour)}});
  for (const ScenePicture& picture : group.pictures) pictures.push_back(picture_json(plan, picture));
  for (const glm::dvec3& p_mm : group.marks_mm) marks.push_back(to_json(p_mm));
  return {{"name", group.name},
          {"title", group.title},
          {"objects", objects},
          {"pictures", pictures},
          {"marks_mm", marks},
          {"most_mm", group.most_mm ? Json(*group.most_mm) : Json(nullptr)},
          {"colours", distance_colours()}};
}

}  // namespace

Json page_counts(const VerdictCounts& counts) {
  Json json = to_json(counts);
  json["pass_not_resolved"] = counts.pass_not_resolved;
  return json;
}

std::vector<std::string> distance_colours() {
  constexpr int steps = 8;
  std::vector<std::string> colours;
  for (int i = 0; i <= steps; ++i)
    colours.push_back(text_of_colour(voxel::diverging_colour(-1.0 + 2.0 * i / steps)));
  return colours;
}

Json report_data(const Result& result) {
  Json groups = Json::array(), contents = Json::array();
  for (const PictureGroup& group : result.pictures) groups.push_back(group_json(result.plan, group));
  for (const Exported& exported : result.exported) contents.push_back(exported.content);
  Json counts = page_counts(verdict_counts(result.evaluation));
  counts["measured"] = to_json(measured_verdicts(result.measurements));
  return {{"kind", "report"},
          {"result", result_json(result)},
          {"patients", result.anonymous ? std::vector<std::string>{"left out as asked"}
                                        : patient_lines(result.evaluation)},
          {"counts", counts},
          {"pictures", groups},
          {"cephalogram", base64(result.cephalogram)},
          {"contents", contents},
          {"plan_text", result.plan.text}};
}

std::string report_html(const Result& result) {
  return drawn_page(result.plan.name, report_data(result),
                    "Without scripts, read result.json and the folders tables and views beside it.");
}

}  // namespace octotomy::planner
