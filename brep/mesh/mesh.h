// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// OpenMesh checks the type of a property at each access by comparing names, which takes a third of the time of a
// decimation. Its own assertions are left out, as those of CGAL and Eigen are; this project's stay. A header of
// OpenMesh that was included before this one, by a source or by a list of precompiled headers, would bring them back.
// clang-format off
#ifdef OPENMESH_PROPERTYCONTAINER
#error "include brep/mesh/mesh.h before any header of OpenMesh: it leaves OpenMesh's slow assertions out"
#endif
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define NDEBUG
#include <cassert>
#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#pragma pop_macro("NDEBUG")
#include <cassert>
// clang-format on

namespace octotomy::brep {

struct MeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};

/// Triangles in LPS millimetres, counter-clockwise seen from outside.
using Mesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

}  // namespace octotomy::brep
