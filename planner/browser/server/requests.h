// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

// The kinds of requests that a page can send, with one function for each. Exceptions of the functions that
// they call pass through.
namespace octotomy::planner::serve {

/// The thread that runs a request. Separate threads let edits run during long tasks; in some lanes a newer
/// request replaces older ones. Certifying has its own thread, so that the quick evaluation after an edit
/// does not stop it.
enum class Lane { Session, Evaluate, Certify, Overlap, Long };

struct RequestKind {
  std::string name;
  Lane lane = Lane::Session;
  bool changes_plan = false;  ///< the answer is the plan's state, which is sent to all windows
  std::function<Json(Session& session, const Json& said, const Watched& watched)> answer;
  bool changes_objects = false;  ///< the plan's state is sent to all windows after the answer
  /// Whether windows that only show the plan may send it. Such a request changes no plan, names no file or
  /// folder, and writes nothing.
  bool may_view = false;
};

const std::vector<RequestKind>& request_kinds();
/// Throws voxel::Error, Input, if there is no such kind; the message proposes the most similar name.
const RequestKind& find_request_kind(const std::string& name);

}  // namespace octotomy::planner::serve
