// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>

#include "brep/mesh/triangles.h"

namespace octotomy::bench {

/// The folder of npm's package manifold-3d: the one in OCTOTOMY_MANIFOLD, or npm's global folder; empty if
/// neither exists.
std::filesystem::path manifold_folder();

/// A Boolean by Manifold, in WebAssembly under node: the median of several in one process, without loading
/// and conversion.
struct ManifoldAnswer {
  double seconds = 0.0;
  std::size_t triangles = 0;
};
ManifoldAnswer manifold_boolean(const brep::Triangles& a, const brep::Triangles& b, bool is_union);

}  // namespace octotomy::bench
