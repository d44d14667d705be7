// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/bench/picture_plane.h"

// OpenVDB behind a narrow door: its headers and oneTBB's do not agree in C++20, so its unit is compiled as
// C++17.

namespace octotomy::bench {

/// A set of voxels as a pruned MaskGrid, and as the BoolGrid that GridTransformer takes.
class OpenVdbPeer {
 public:
  /// From one bit a voxel, x fastest, 64 voxels a word.
  OpenVdbPeer(int side, const std::vector<std::uint64_t>& words);
  ~OpenVdbPeer();
  OpenVdbPeer(const OpenVdbPeer&) = delete;
  OpenVdbPeer& operator=(const OpenVdbPeer&) = delete;

  /// Copies this mask and applies a topology operation with the other one to the copy. Gives back its voxels
  /// where `count`, as that costs time of its own.
  enum class Operation { Union, Intersection, Difference };
  std::uint64_t combine(Operation operation, const OpenVdbPeer& other, bool count) const;
  /// Resamples by the nearest voxel under a map of voxel indices, columns first. Gives back voxels where
  /// `count`.
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

  /// Draws a picture with its diffuse shader and gives back the number of lit pixels.
  int draw(const PicturePlane& plane) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

/// A closed mesh made a level set by meshToVolume, the way into OpenVDB's volumes, and its inside.
class OpenVdbVoxeliser {
 public:
  OpenVdbVoxeliser(const FlatMesh& mesh, double voxel_mm);
  ~OpenVdbVoxeliser();
  OpenVdbVoxeliser(const OpenVdbVoxeliser&) = delete;
  OpenVdbVoxeliser& operator=(const OpenVdbVoxeliser&) = delete;

  /// Voxelises anew and gives back the active voxels of its narrow band.
  std::uint64_t band_voxels() const;

 private:
  struct Mesh;
  std::unique_ptr<Mesh> mesh_;
};

}  // namespace octotomy::bench
