// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

// The requests of a page to the session, one function per kind. All pass on exceptions of the functions that
// they call.
namespace octotomy::planner::serve {

/// The server's thread that handles a request: edits do not wait for long tasks, and for some kinds only the
/// newest request is needed. A certifying evaluation has its own thread, so that the quick evaluation after
/// an edit does not stop it.
enum class Lane { Session, Evaluate, Certify, Overlap, Long };

struct RequestKind {
  std::string name;
  Lane lane = Lane::Session;
  bool changes_plan = false;  ///< the answer is the plan's state, which is sent to all windows
  std::function<Json(Session& session, const Json& said, const Watched& watched)> answer;
  bool changes_objects = false;  ///< the plan's state is sent to all windows
  /// Whether windows that may only look are answered too. Such a request changes no plan, names no file or
  /// folder and writes nothing.
  bool may_view = false;
};

const std::vector<RequestKind>& request_kinds();
/// Throws voxel::Error, Input, if there is no such kind; the message names the nearest one.
const RequestKind& find_request_kind(const std::string& name);

}  // namespace octotomy::planner::serve
