// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "brep/align/register_landmarks.h"
#include "convert/deck/deck.h"

namespace octotomy::planner {

/// Throws std::runtime_error if a word NAME=WHERE has no name, a name that solvers refuse or that the deck's
/// own sets use, or if two names are equal apart from case. For refusals before the work.
void check_set_names(const std::vector<std::string>& words);

/// Sets of nodes of the elements' surface, in LPS millimetres, each as NAME=WHERE:
///   x,y,z          the node nearest to a point, as x,y,z,0
///   x,y,z,r        the nodes within r mm of a point
///   x,y,z,u,v,w    the nodes on a plane through a point with a normal, as after a saw cut
///   TEXT           the node nearest to a landmark of that name, or the nodes on the surface of a mesh file
/// On a plane or surface means nearer than a quarter of the mean side of the elements' surface triangles. Where
/// triangles of the elements' surface lie along a plane, within 30 degrees, only their nodes are on it: other
/// nodes that near belong to the faces beside it. Nodes more than three times as far off the plane as the
/// median are left out, because they belong to the rounded edges of the face. Throws std::runtime_error as
/// check_set_names(), where the text is none of these, or a set is empty.
std::vector<convert::NodeSet> picked_node_sets(const std::vector<std::string>& words,
                                               const std::vector<brep::Landmark>& landmarks,
                                               const convert::Tetrahedra& tetrahedra);

/// The static step: fixed sets, and moved sets as NAME=DX,DY,DZ in mm. Throws std::runtime_error if no set
/// has a given name, if a fixed and a moved set share a node, or if a set moves and none is fixed.
std::vector<convert::Prescribed> prescribed_of(const std::vector<std::string>& fixed,
                                               const std::vector<std::string>& moved,
                                               const std::vector<convert::NodeSet>& sets);

}  // namespace octotomy::planner
