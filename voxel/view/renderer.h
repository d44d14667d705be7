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

/// Draws frame after frame for a screen. Keeps an object's layer while its voxels, samples, cuts and the view
/// stay the same, and the whole picture while nothing changes. The result is bit for bit that of a new
/// Renderer. One thread at a time may use it.
///
/// Every object has a layer of its own, so that moving a fragment does not redraw the skull's layer. The
/// nearest surface wins. Where two objects lie within a voxel of each other along a ray of node tracing,
/// render() may show the other object, because it compares voxels before it interpolates depths. A hidden
/// object keeps its layer, but none is traced for it. Memory: for each object and size, a depth image and the
/// algorithm's data.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Counts of the layers and pictures of all frames so far.
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
  /// edges, and then with the full frame; only with the full frame if all its layers are cached. Stops
  /// between layers and pictures, never within one, and keeps the finished ones. Throws as frame() does, and
  /// Stopped.
  void refine(const std::vector<DrawnObject>& objects, const RenderOptions& options,
              const std::function<void(const Picture&)>& show, const Progress& progress = {});

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace octotomy::voxel
