// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

// Requests of a page for numbers, certificates and files of the plan's objects. requests.h has the requests
// that change or show the document.
namespace octotomy::planner::serve {

/// {"kind", "points" or "object"} -> {"value", "unit", "half_width", "sentence"}: the result of a step
/// "measure" that is not in the plan.
Json measure(Session& session, const Json& said, const Watched& watched);
/// {"object"} -> {"verdict", "sentence", "place", "detection_limit", "rows", "certificate"}: evaluates an
/// object in both kernels. Without a certificate the last member is absent, and "sentence" states why.
Json certify(Session& session, const Json& said, const Watched& watched);
/// {"object", "with", "move"} -> {"mm3"}: the volume in which the moved object overlaps the objects "with",
/// by the voxel kernel.
Json overlap(Session& session, const Json& said, const Watched& watched);
/// {"object", "near_mm"} -> {"parts", "whole_mm3", "mm3", "at_mm"}: the number of an object's connected
/// parts, the object's volume, the volume of the part at the point "near_mm", and the centre of a voxel of
/// this part. Without "near_mm": volume and centroid of the largest part; "at_mm" is null if the object is
/// empty.
Json part(Session& session, const Json& said, const Watched& watched);
/// {"steps"} -> {"objects": [{"id", "mm3"}], "scans": [{"id", "details", "findings"}]}: the results of steps
/// as if they stood at the end of the plan, by the voxel kernel. Does not change the plan.
Json try_steps(Session& session, const Json& said, const Watched& watched);
/// {"path", "frame", "unit"} -> {"audit"}: the frame and unit that a mesh file states, and how its size and
/// position fit the plan's first scan. The path is relative to the plan's folder.
Json mesh_audit(Session& session, const Json& said, const Watched& watched);
/// {"object"} -> {"rows"}: the rows of the movement table that belong to an object; all rows if "object" is
/// absent.
Json movement(Session& session, const Json& said, const Watched& watched);
/// {"name", "point", "snap"} -> {"point", "snapped"}: places a landmark of the plan; with "snap", on the
/// nearest bone if there is any near.
Json place_landmark(Session& session, const Json& said, const Watched& watched);
/// {"object"} -> {"landmarks", "missing", "findings"}: proposes landmarks on an object. Does not place them.
Json find_landmarks(Session& session, const Json& said, const Watched& watched);
/// {"object", "path"} -> {"file"}: writes an object to a file in the plan's folder of exports.
Json export_file(Session& session, const Json& said, const Watched& watched);
/// {"anonymous"} -> {"folder", "file", "counts", "left_out"}: writes a report of all steps with results.
/// Leaves out steps that failed and steps that need them, each with a finding.
Json report(Session& session, const Json& said, const Watched& watched);
/// {"path", "low", "unmoved"} -> the outcome as JSON: compares a scan made after the operation with the plan.
Json outcome(Session& session, const Json& said, const Watched& watched);
/// {"step"} -> {"shell", "python"}: shell commands that evaluate a step with the steps on which it depends,
/// and Python that adds it to a plan.
Json command_of_step(Session& session, const Json& said, const Watched& watched);

/// The folder of the open plan's exports and reports: "NAME files" beside the plan.
std::filesystem::path files_folder(const Session& session);

}  // namespace octotomy::planner::serve
