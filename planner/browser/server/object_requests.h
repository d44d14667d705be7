// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

// Requests for numbers, certificates and files of the plan's objects. Those that change or show the document
// are in requests.h.
namespace octotomy::planner::serve {

/// {"kind", "points" or "object"} -> {"value", "unit", "half_width", "sentence"}, as for a step "measure".
Json measure(Session& session, const Json& said, const Watched& watched);
/// {"object"} -> {"verdict", "sentence", "place", "detection_limit", "rows"}, and "certificate" if there is
/// one.
Json certify(Session& session, const Json& said, const Watched& watched);
/// {"object", "with", "move"} -> {"mm3"}, in voxels.
Json overlap(Session& session, const Json& said, const Watched& watched);
/// {"object", "near_mm"} -> {"parts", "whole_mm3", "mm3", "at_mm"}: the number of the object's connected
/// parts and the object's volume; then the volume of the part at the point, and the centre of a voxel in it.
/// Without a point: volume and centroid of the largest part; the centroid is null if the object is empty.
Json part(Session& session, const Json& said, const Watched& watched);
/// {"steps"} -> {"objects": [{"id", "mm3"}], "scans": [{"id", "details", "findings"}]}: the results of
/// further steps after those of the plan, in voxels. Does not change the plan.
Json try_steps(Session& session, const Json& said, const Watched& watched);
/// {"path", "frame", "unit"} -> {"audit"}: a mesh file's statements on its frame and unit, and how its size
/// and position fit the plan's first scan. The path is relative as in a plan.
Json mesh_audit(Session& session, const Json& said, const Watched& watched);
/// {"object"} -> {"rows"}: its rows of the movement table; without "object", all rows.
Json movement(Session& session, const Json& said, const Watched& watched);
/// {"name", "point", "snap"} -> {"point", "snapped"}: names a point; with "snap", moves it to the nearest
/// bone if one is near.
Json place_landmark(Session& session, const Json& said, const Watched& watched);
/// {"object"} -> {"landmarks", "missing", "findings"}: proposed landmarks; does not place them.
Json find_landmarks(Session& session, const Json& said, const Watched& watched);
/// {"object", "path"} -> {"file"}, writes the file into the plan's folder of exports.
Json export_file(Session& session, const Json& said, const Watched& watched);
/// {"anonymous"} -> {"folder", "file", "counts", "left_out"}: a report of all steps with results. Steps that
/// failed, and those that depend on them, are left out, each with a finding.
Json report(Session& session, const Json& said, const Watched& watched);
/// {"path", "low", "unmoved"} -> the outcome's JSON: compares a later scan with the plan.
Json outcome(Session& session, const Json& said, const Watched& watched);
/// {"step"} -> {"shell", "python"}: commands that evaluate the step and the steps on which it depends, and
/// commands that add it to a plan.
Json command_of_step(Session& session, const Json& said, const Watched& watched);

/// The folder of the open plan's exports and reports: "NAME files" beside the plan.
std::filesystem::path files_folder(const Session& session);

}  // namespace octotomy::planner::serve
