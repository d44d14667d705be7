// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>

#include "tests/bench/picture_plane.h"

namespace octotomy::bench {

/// A dense scan in VTK's flying edges, on the given number of threads; normals and gradients are not
/// computed.
class VtkContour {
 public:
  VtkContour(const FlatScan& scan, double value, int threads);
  ~VtkContour();
  VtkContour(const VtkContour&) = delete;
  VtkContour& operator=(const VtkContour&) = delete;

  /// Extracts the surface again and returns its number of triangles.
  std::size_t triangles() const;
  /// The surface that triangles() extracted last, in LPS millimetres.
  FlatMesh surface() const;

 private:
  struct Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace octotomy::bench
