// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "voxel/render.h"

namespace octotomy::voxel {

/// Draws frame after frame for a screen and keeps what does not change between them: an object's layer while
/// its voxels, samples, cuts and the view stay, the whole picture while nothing does. The same bits as a
/// Renderer that has kept nothing. One thread at a time may use it.
///
/// Every object is a layer of its own, so that a moved fragment leaves the skull's layer alone; the nearest
/// is seen. Where node tracing finds two objects within a voxel of each other, render(), which compares their
/// voxels before it interpolates depths, may show the other one. Objects hidden behind others are drawn too.
/// Memory: a depth image and what its algorithm keeps, an object and a size.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// What frames were made of so far.
  struct Tally {
    std::uint64_t layers_drawn = 0;
    std::uint64_t layers_kept = 0;
    std::uint64_t pictures_shaded = 0;
    std::uint64_t pictures_kept = 0;
  };
  const Tally& tally() const;

  /// The frame in full. Throws as render(), and std::invalid_argument where visits are to be counted.
  Picture frame(const std::vector<Drawn>& objects, const RenderOptions& options);

  /// Shows the frame as soon as there is something to see: of a quarter, then half of the pixels along each
  /// side, edges not blended, then in full; at once in full where every layer of that is kept. `show` is
  /// given each as it is done. False where it was stopped: between layers and pictures, never within one;
  /// what was done until then is kept. Throws as frame().
  bool refine(const std::vector<Drawn>& objects, const RenderOptions& options,
              const std::function<void(const Picture&)>& show, const std::stop_token& stop = {});

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace octotomy::voxel
