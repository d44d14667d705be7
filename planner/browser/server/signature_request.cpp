// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/signature_request.h"

#include "planner/operation/table/control_character.h"
#include "planner/plan/signature.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

/// in bytes, as for the name of a branch
constexpr std::size_t longest_text = 200;

std::string text_in(const Json& said, const char* key, const std::string& usual) {
  const std::string text = said.value(key, usual);
  need_no_control(text, std::string("'") + key + "'");
  if (text.size() > longest_text)
    throw voxel::Error(voxel::ErrorCode::Input, std::string("'") + key + "' has " +
                                                    std::to_string(text.size()) + " bytes, and may have " +
                                                    std::to_string(longest_text));
  return text;
}

Json listed(const std::string& text, const std::map<std::string, std::string>& sums) {
  Json list = Json::array();
  for (const Signature& signature : signatures_of(text)) {
    list.push_back(planner::to_json(signature));
    list.back()["changed_since"] = changed_since(signature, text, sums);
  }
  return {{"signatures", list}};
}

}  // namespace

Json signatures(Session& session, const Json&, const Watched&) {
  const auto plan = session.with_document([](const Document& document) { return document.plan(); });
  return listed(plan->text, sums_of_scans(*plan));
}

Json sign_plan(Session& session, const Json& said, const Watched&) {
  const std::string by = text_in(said, "by", ""), as = text_in(said, "as", "reader"),
                    note = text_in(said, "note", "");
  if (by.empty()) throw voxel::Error(voxel::ErrorCode::Input, "a signature needs a name");
  const auto plan = session.with_document([](const Document& document) { return document.plan(); });
  const Signature signature = sign(*plan, by, as, note);
  const std::string text = with_signature(plan->text, signature);
  session.with_document([&](Document& document) {
    if (document.plan()->text != plan->text)
      throw voxel::Error(voxel::ErrorCode::Input,
                         "the plan was changed while its scans were read: read it, and sign again");
    document.record(Json::parse(text), "signed by " + by);
  });
  return listed(text, signature.scans_sha256);
}

}  // namespace octotomy::planner::serve
