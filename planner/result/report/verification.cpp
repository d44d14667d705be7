// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/verification.h"

#include "planner/operation/table/json_file.h"
#include "planner/result/report/difference_pictures.h"
#include "planner/result/report/drawn_page.h"
#include "planner/result/report/report_page.h"
#include "planner/result/report/result_folder.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

/// The worst certificate, with pictures of the difference between both answers; null if one of them is empty.
Json worst_json(const std::optional<verify::Contested>& worst) {
  if (!worst || worst->octree.is_empty() || !worst->solid || worst->solid->empty()) return nullptr;
  const DifferencePictures drawn = difference_pictures(*worst);
  Json pictures = Json::array();
  for (const ScenePicture& picture : drawn.group.pictures)
    pictures.push_back({{"view", picture.view}, {"png", base64(picture.png)}});
  const verify::Certificate& certificate = worst->certificate;
  return {{"operation", certificate.operation},
          {"verdict", to_string(certificate.verdict)},
          {"resolved", certificate.resolved()},
          {"reasons", certificate.reasons},
          {"share", verify::worst_share(certificate)},  // printed as null where it is infinite
          {"most_mm", drawn.most_mm},
          {"colours", distance_colours()},
          {"pictures", pictures}};
}

/// Those members of a certificate that the page draws. The page does not contain whole certificates, because
/// suites have thousands; result.json does.
Json drawn_part(const Json& certificate) {
  const auto part_of = [](const Json& whole, const std::vector<const char*>& names) {
    Json part = Json::object();
    for (const char* name : names)
      if (whole.contains(name)) part[name] = whole[name];
    return part;
  };
  Json part =
      part_of(certificate, {"operation", "tier", "verdict", "resolved", "not_resolved_because", "reasons",
                            "findings", "shared_makers", "shared_values", "difference_mm3", "tolerance_mm3"});
  for (const char* kernel : {"voxel", "mesh"}) part[kernel] = part_of(certificate.at(kernel), {"volume_mm3"});
  part["comparisons"] = Json::array();
  for (const Json& one : certificate.at("comparisons"))
    part["comparisons"].push_back(part_of(one, {"quantity", "difference", "tolerance", "verdict"}));
  return part;
}

}  // namespace

std::string verification_html(const Verification& verification) {
  Json answer = verification.answer;
  for (Json& certificate : answer.at("certificates")) certificate = drawn_part(certificate);
  return drawn_page("Verification: " + verification.subject,
                    {{"kind", "verification"},
                     {"octotomy", OCTOTOMY_VERSION},
                     {"subject", verification.subject},
                     {"counts", page_counts(verification.counts)},
                     {"answer", answer},
                     {"not_covered", verification.not_covered},
                     {"worst", worst_json(verification.worst)}},
                    "Without scripts, read result.json beside it.");
}

void write_verification(const Verification& verification, const std::filesystem::path& folder) {
  ResultFolder result(folder);
  voxel::write_file(result.path() / "report.html", verification_html(verification));
  voxel::write_file(result.path() / "result.json", json_text(verification.answer, 2) + "\n");
  result.publish();
}

}  // namespace octotomy::planner
