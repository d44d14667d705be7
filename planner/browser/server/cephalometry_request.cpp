// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/cephalometry_request.h"

#include "planner/procedure/cephalometry/cephalogram.h"
#include "planner/procedure/cephalometry/measured.h"
#include "planner/result/report/drawn_page.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

/// Width and height of the tracing: enough for a dialog that fills the page.
constexpr int tracing_px = 900;

std::string tracing_of(const Objects& objects, const Cephalometry& definitions,
                       const std::vector<MovedLandmark>& landmarks, const Watched& watched) {
  for (const Object& object : objects) {
    if (!object.shown || object.moved) continue;
    const Cephalogram drawn = draw_cephalogram(object.shown->grey, definitions, landmarks,
                                               objects.lps_from_head, tracing_px, {watched.stop, {}});
    return base64(voxel::encode_image("png", drawn.size_px, drawn.rgb));
  }
  return {};
}

}  // namespace

Json cephalometry(Session& session, const Json&, const Watched& watched) {
  const Snapshot made = session.evaluate(std::vector<std::string>{}, false, watched);
  const Objects& objects = made.evaluation->objects;
  const Cephalometry definitions = read_cephalometry("lateral");
  const std::vector<MovedLandmark> landmarks = moved_landmarks(objects, made.plan->landmarks);
  const CephalometricResults found = measured(definitions, landmarks, objects.lps_from_head);
  if (found.measured.empty())
    throw voxel::Error(
        voxel::ErrorCode::Input,
        "the plan's landmarks allow no cephalometric measure: place sella, nasion and a_point, for "
        "example, under these names");
  Json findings = Json::array();
  for (const auto& [step, why] : made.errors)
    findings.push_back("'" + step + "' failed, so the objects that it moves count as unmoved: " + why);
  return {{"table", planner::to_json(found, {})},
          {"cephalogram", tracing_of(objects, definitions, landmarks, watched)},
          {"findings", findings}};
}

}  // namespace octotomy::planner::serve
