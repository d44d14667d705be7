// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/bench/picture_plane.h"

// An interface without OpenVDB's headers, which conflict with oneTBB's in C++20. So its unit is compiled as
// C++17.

namespace octotomy::bench {

/// A set of voxels as a pruned MaskGrid, and as the BoolGrid that GridTransformer takes.
class OpenVdbPeer {
 public:
  /// `words` has one bit a voxel, x fastest, 64 voxels a word.
  OpenVdbPeer(int side, const std::vector<std::uint64_t>& words);
  ~OpenVdbPeer();
  OpenVdbPeer(const OpenVdbPeer&) = delete;
  OpenVdbPeer& operator=(const OpenVdbPeer&) = delete;

  /// Copies this mask and applies a topology operation with the other one to the copy. Returns the number of
  /// voxels if `count` is true, because counting takes additional time.
  enum class Operation { Union, Intersection, Difference };
  std::uint64_t combine(Operation operation, const OpenVdbPeer& other, bool count) const;
  /// Resamples by the nearest voxel under a map of voxel indices, columns first. Returns the number of voxels
  /// if `count` is true.
  std::uint64_t transform(const std::array<double, 16>& target_from_source, bool count) const;
  std::uint64_t bytes() const;

 private:
  struct Grids;
  std::unique_ptr<Grids> grids_;
};

/// A surface as a level set in world millimetres, drawn by LevelSetRayTracer.
class OpenVdbSurface {
 public:
  OpenVdbSurface(const FlatMesh& mesh, double voxel_mm);
  ~OpenVdbSurface();
  OpenVdbSurface(const OpenVdbSurface&) = delete;
  OpenVdbSurface& operator=(const OpenVdbSurface&) = delete;

  /// Draws a picture with OpenVDB's diffuse shader and returns the number of lit pixels.
  int draw(const PicturePlane& plane) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

/// Converts a closed mesh to a level set by meshToVolume, as OpenVDB reads volumes, and computes its inside.
class OpenVdbVoxeliser {
 public:
  OpenVdbVoxeliser(const FlatMesh& mesh, double voxel_mm);
  ~OpenVdbVoxeliser();
  OpenVdbVoxeliser(const OpenVdbVoxeliser&) = delete;
  OpenVdbVoxeliser& operator=(const OpenVdbVoxeliser&) = delete;

  /// Voxelises the mesh again and returns the number of active voxels of its narrow band.
  std::uint64_t band_voxels() const;

 private:
  struct Mesh;
  std::unique_ptr<Mesh> mesh_;
};

}  // namespace octotomy::bench
