// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <vector>

#include "planner/browser/server/message.h"

namespace octotomy::planner::serve {

/// A pane of a window.
struct PaneName {
  std::uint64_t window = 0;
  int pane = 0;

  auto operator<=>(const PaneName&) const = default;
};

/// The queue of pictures to draw. Each pane has at most one waiting request, the newest. A moving pane also
/// waits while most_in_flight of its frames are not yet on the screen, so that a slow page receives fewer
/// frames instead of outdated ones. Panes take turns. A picture that is no longer needed is stopped while it
/// is drawn. All members may be called from any thread.
class PaneQueue {
 public:
  static constexpr std::size_t most_in_flight = 2;

  struct PaneRequest {
    PaneName name;
    Request request;
    bool is_moving = false;
    std::stop_source stop{};  ///< stops drawing it
  };

  /// Queues a request in place of the pane's older one. The caller must first call withdraw() to answer the
  /// older one; otherwise it is dropped without an answer. Stops the pane's current picture, unless both
  /// requests are moving, so that frames appear even if requests arrive faster.
  void ask(PaneRequest asked);
  /// Removes a pane's waiting request.
  std::optional<PaneRequest> withdraw(const PaneName& name);
  /// Removes a waiting request by the request's number.
  std::optional<PaneRequest> withdraw(std::uint64_t window, std::int64_t id);
  /// Stops a request while it is drawn; returns whether it was.
  bool stop(std::uint64_t window, std::int64_t id);
  /// The next request whose pane is free; waits for one. None: stopped.
  std::optional<PaneRequest> next(const std::stop_token& stop);
  /// Records that the page has shown a frame.
  void shown(const PaneName& name, std::int64_t frame);
  /// The number of panes that share the drawing time: those with a moving request or frames in flight, at
  /// least 1.
  int moving_panes() const;
  /// Removes a pane and stops its current picture. Returns its waiting request.
  std::optional<PaneRequest> close(const PaneName& name);
  /// Removes all panes of a closed window, and stops a picture of it that is being drawn.
  void close_window(std::uint64_t window);

 private:
  struct Pane {
    std::optional<PaneRequest> waiting;
    std::set<std::int64_t> in_flight;  ///< moving frames that the page has not shown yet
    std::uint64_t served = 0;          ///< turn in which it was served last
  };
  /// The last result of next(), until its next call.
  struct Drawn {
    PaneName name;
    std::int64_t id = 0;
    bool is_moving = false;
    std::stop_source stop;
  };
  std::map<PaneName, Pane>::iterator ready();
  /// Stops the current picture if `test` is true for it; returns whether it is.
  template <typename Test>
  bool stop_if(const Test& test);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::map<PaneName, Pane> panes_;
  std::optional<Drawn> drawn_;
  std::uint64_t turn_ = 0;
};

}  // namespace octotomy::planner::serve
