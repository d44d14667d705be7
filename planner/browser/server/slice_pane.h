// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stop_token>

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// A frame for a request "pane" of the kind "slice": a plane of the scan in grey tones with the outlines of
/// objects, with samples in `threshold` tinted. During a motion a JPEG; at rest a PNG with the samples of the
/// pixels. Throws std::runtime_error for an invalid request; Stopped.
Message draw_slice(Session& session, const Request& request, const std::stop_token& stop);

}  // namespace octotomy::planner::serve
