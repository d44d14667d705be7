// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/merge_request.h"

#include <sstream>

#include "planner/plan/difference.h"
#include "planner/plan/merge.h"
#include "planner/plan/rebase.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

std::size_t changed_values(const PlanDifference& found) {
  std::size_t count =
      found.document.size() + found.added.size() + found.removed.size() + found.reordered.size();
  for (const StepChange& step : found.changed) count += step.fields.size();
  return count;
}

/// The state of the document's history from which another plan differs in the fewest values; the newest of
/// several.
std::int64_t nearest_state(const Document& document, const Plan& other) {
  std::int64_t nearest = document.history_json().at("edit");
  std::size_t least = changed_values(difference(*document.plan(), other));
  const Json states = document.history_json().at("history");
  for (auto state = states.rbegin(); state != states.rend() && least > 0; ++state) {
    const std::int64_t edit = state->at("id");
    const std::size_t count = changed_values(difference(document.plan_at(edit), other));
    if (count >= least) continue;
    least = count;
    nearest = edit;
  }
  return nearest;
}

struct Attempt {
  std::int64_t base = 0;
  Merged merged;
};

Attempt attempt(const Document& document, const std::filesystem::path& path, const Json& base) {
  const Plan other = rebased(document.other(path), document.path().parent_path());
  Attempt made;
  made.base = base.is_number_integer() ? base.get<std::int64_t>() : nearest_state(document, other);
  made.merged = merge(document.plan_at(made.base), *document.plan(), other);
  return made;
}

Json described(const Document& document, const Attempt& made) {
  Json conflicts = Json::array(), rows = Json::array();
  for (const MergeConflict& conflict : made.merged.conflicts)
    conflicts.push_back({{"step", conflict.step},
                         {"field", conflict.field},
                         {"base", conflict.base},
                         {"a", conflict.a},
                         {"b", conflict.b},
                         {"text", conflict.text()}});
  if (conflicts.empty()) {
    std::istringstream text(
        text_of(difference(*document.plan(), document.parsed(Json::parse(made.merged.text)))));
    for (std::string line; std::getline(text, line);) rows.push_back(line);
  }
  return {{"base", made.base}, {"conflicts", conflicts}, {"rows", rows}};
}

std::filesystem::path path_of(const Session& session, const Json& said) {
  return session.folders.need_within(said.at("path").get<std::string>());
}

}  // namespace

Json try_merge(Session& session, const Json& said, const Watched&) {
  const std::filesystem::path path = path_of(session, said);
  return session.with_document([&](const Document& document) {
    return described(document, attempt(document, path, said.value("base", Json())));
  });
}

Json merge_plan(Session& session, const Json& said, const Watched&) {
  const std::filesystem::path path = path_of(session, said);
  return session.with_document([&](Document& document) {
    const Attempt made = attempt(document, path, said.value("base", Json()));
    std::string conflicts;
    for (const MergeConflict& conflict : made.merged.conflicts)
      conflicts += (conflicts.empty() ? "" : "; ") + conflict.text();
    if (!conflicts.empty())
      throw voxel::Error(voxel::ErrorCode::Input,
                         "both plans changed the same values: " + conflicts +
                             "; change one plan to the other's values and merge again");
    Json said_of_it = described(document, made);
    document.record(Json::parse(made.merged.text), "merged with " + plain_stem(path));
    return said_of_it;
  });
}

}  // namespace octotomy::planner::serve
