// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"
#include "voxel/view/renderer.h"

namespace octotomy::planner::serve {

/// Draws the views of one pane. Remembers how long earlier frames took. Only one thread at a time may use it.
class ViewPane {
 public:
  /// A frame for a request "pane" of the kind "view". During a motion it is a JPEG, with fewer pixels if all
  /// would take longer than `most_ms`. At rest it is the PNG of `octotomy render`, with depth and object of
  /// every pixel. Throws std::runtime_error for an invalid request; Stopped.
  Message draw(Session& session, const Request& request, double most_ms, const std::stop_token& stop);

 private:
  struct Drawing;
  /// Adds the objects of a request. A dragged piece is added at its new position.
  void add_objects(Session& session, const Json& said, Drawing& drawing, const std::stop_token& stop);
  /// Colours an object by its distance to another; with "mutual", each of the two by its distance to the
  /// other.
  void colour(const Json& colour_by, Drawing& drawing);
  /// A window on a scan that is not a step of the plan; with "alone", in a universe around the scan.
  voxel::DrawnObject threshold(Session& session, const Snapshot& snapshot, const Json& window);
  Message moving(Drawing& drawing, double most_ms);
  /// A picture computed along rays. During a motion it has fewer pixels if all would take longer than
  /// `most_ms`.
  Message along_rays(Drawing& drawing, double most_ms, const std::stop_token& stop);
  /// The scale of a picture's sides that can be drawn in this time, from least_scale to 1.
  double scale_within(double most_ms) const;
  void learn_frame_time(const std::chrono::steady_clock::time_point& start, double scale);

  voxel::Renderer renderer_;
  double full_frame_ms_ = 0.0;  ///< estimated from the last frames; 0: not known yet
  std::string threshold_of_;
  std::shared_ptr<const voxel::Octree> threshold_;
  std::shared_ptr<const Evaluation> scalar_evaluation_;
  std::map<std::string, std::shared_ptr<const voxel::SurfaceScalar>> scalars_;  ///< by objects and range
};

}  // namespace octotomy::planner::serve
