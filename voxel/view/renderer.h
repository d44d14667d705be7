// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {

/// Draws frame after frame for a screen. Caches an object's layer as long as the object's voxels and samples,
/// the cuts and the view do not change, and the whole picture as long as nothing changes. The result has the
/// same bits as that of a new Renderer. One thread at a time may use it.
///
/// Every object has a separate layer, so that moving a fragment does not redraw the skull's layer. At every
/// pixel the nearest surface is visible. Where two objects lie within a voxel of each other along a ray of
/// node tracing, render() may show the other object, because it compares voxels before it interpolates
/// depths. The layer of a hidden object stays cached, but if there is none, it is not traced. Memory: for
/// each object and size, a depth image and the algorithm's data.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Numbers of layers and pictures that were traced, shaded or reused in all frames so far.
  struct Tally {
    std::uint64_t layers_drawn = 0;
    std::uint64_t layers_kept = 0;
    std::uint64_t pictures_shaded = 0;
    std::uint64_t pictures_kept = 0;
  };
  const Tally& tally() const;

  /// The full frame. Throws as render() does, and std::invalid_argument if RenderOptions::count is set.
  Picture frame(const std::vector<DrawnObject>& objects, const RenderOptions& options);

  /// Calls `show` with the frame at a quarter and at half of the pixels along each side, without blended
  /// edges, and then with the full frame; only with the full frame if all its layers are cached. A stop takes
  /// effect between layers and pictures, never within one; finished ones are kept. Throws as frame() does,
  /// and Stopped.
  void refine(const std::vector<DrawnObject>& objects, const RenderOptions& options,
              const std::function<void(const Picture&)>& show, const Progress& progress = {});

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace octotomy::voxel
