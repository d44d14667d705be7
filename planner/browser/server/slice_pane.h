// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stop_token>

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// A frame for a request "pane" of the kind "slice": a slice of the scan in grey tones with the outlines of
/// objects; the samples in "threshold" are tinted. During a motion the frame is a JPEG; at rest it is a PNG
/// with the sample at every pixel. Throws std::runtime_error for an invalid request; Stopped.
Message draw_slice(Session& session, const Request& request, const std::stop_token& stop);

}  // namespace octotomy::planner::serve
