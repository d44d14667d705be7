// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/desk.h"
#include "planner/browser/server/message.h"

// Requests that ask for numbers, proofs and files of the plan's objects; those of requests.h that change or
// show the document stand there.
namespace octotomy::planner::serve {

/// {"kind", "points" or "object"} -> {"value", "unit", "half_width", "sentence"}, as a step "measure" has it.
Json measure(Desk& desk, const Json& said, const Watched& watched);
/// {"object"} -> {"verdict", "sentence", "place", "detection_limit", "rows"}.
Json certify(Desk& desk, const Json& said, const Watched& watched);
/// {"object", "with", "move"} -> {"mm3"}, in voxels.
Json overlap(Desk& desk, const Json& said, const Watched& watched);
/// {"object"} -> {"parts", "mm3", "at_mm"}: its connected parts, and the centroid of the largest; null where
/// it is empty.
Json largest_part(Desk& desk, const Json& said, const Watched& watched);
/// {"path", "frame", "unit"} -> {"audit"}: what a mesh file says of its frame and unit, and how its size and
/// place fit the plan's first scan. The path is a plan's.
Json mesh_audit(Desk& desk, const Json& said, const Watched& watched);
/// {"object"} -> {"rows"}: its movement in words.
Json movement(Desk& desk, const Json& said, const Watched& watched);
/// {"name", "point", "snap"} -> {"point", "snapped"}: names a point, on the nearest bone where it snaps and
/// one is near.
Json place_landmark(Desk& desk, const Json& said, const Watched& watched);
/// {"object"} -> {"landmarks", "missing", "findings"}: a first guess, which places none.
Json find_landmarks(Desk& desk, const Json& said, const Watched& watched);
/// {"object", "path"} -> {"file"}, which is written into the plan's folder of exports.
Json export_file(Desk& desk, const Json& said, const Watched& watched);
/// {"anonymous"} -> {"folder", "file", "counts", "left_out"}: a report of all that has an answer. Steps that
/// failed, and those that need them, are left out, each with a finding.
Json report(Desk& desk, const Json& said, const Watched& watched);
/// {"path", "low", "unmoved"} -> the outcome's JSON: what a later scan shows of the plan.
Json outcome(Desk& desk, const Json& said, const Watched& watched);
/// {"step"} -> {"shell", "python"}: what makes the step and what it needs, and adds it to a plan.
Json command_of_step(Desk& desk, const Json& said, const Watched& watched);

/// Where the open plan's exports and reports are written: "NAME files" beside it.
std::filesystem::path files_folder(const Desk& desk);

}  // namespace octotomy::planner::serve
