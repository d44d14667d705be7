// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "brep/align/register_landmarks.h"
#include "convert/deck/deck.h"

namespace octotomy::planner {

/// Throws std::runtime_error if a word is not NAME=WHERE, if solvers refuse the name or every deck has a set
/// of that name, or if two names differ at most in capitals. Called before the work, so that no work is lost.
void check_set_names(const std::vector<std::string>& words);

/// Reads sets of surface nodes, each a word NAME=WHERE with coordinates in LPS millimetres. WHERE is one of:
///   x,y,z          the node nearest to a point, the same as x,y,z,0
///   x,y,z,r        the nodes within r mm of a point
///   x,y,z,u,v,w    the nodes on a plane through the point x,y,z with the normal u,v,w
///   TEXT           the node nearest to a landmark of that name, or the nodes on the surface of a mesh file
/// A node lies on a plane or surface if it is nearer than a quarter of the mean side of the elements' surface
/// triangles. If some of these triangles lie along a plane, within 30 degrees, only their nodes count as on
/// the plane, because other nodes as near belong to the faces beside it. Of these, nodes more than three
/// times as far off the plane as the median are left out, because they belong to the rounded edges of the
/// face. Throws std::runtime_error as check_set_names(), if WHERE is none of these, or if a set is empty.
std::vector<convert::NodeSet> picked_node_sets(const std::vector<std::string>& words,
                                               const std::vector<brep::Landmark>& landmarks,
                                               const convert::Tetrahedra& tetrahedra);

/// The displacements of a static step: `fixed` names sets that stay, `moved` has words NAME=DX,DY,DZ in mm.
/// Throws std::runtime_error if there is no set of a name, if two of these sets share a node, or if a set
/// moves and none is fixed.
std::vector<convert::Prescribed> prescribed_of(const std::vector<std::string>& fixed,
                                               const std::vector<std::string>& moved,
                                               const std::vector<convert::NodeSet>& sets);

}  // namespace octotomy::planner
