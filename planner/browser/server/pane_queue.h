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

/// Identifies a pane: the number of its window, and its number within the window.
struct PaneName {
  std::uint64_t window = 0;
  int pane = 0;

  auto operator<=>(const PaneName&) const = default;
};

/// The queue of pictures to draw, for all panes of all windows. Each pane has at most one waiting request,
/// the newest. A moving pane waits while the page has not shown most_in_flight of its frames, so that a slow
/// page receives fewer frames instead of outdated ones. Panes take turns. A picture that is no longer needed
/// is stopped while it is drawn. All members may be called from any thread.
class PaneQueue {
 public:
  static constexpr std::size_t most_in_flight = 2;

  struct PaneRequest {
    PaneName name;
    Request request;
    bool is_moving = false;
    std::stop_source stop{};  ///< stops drawing it
  };

  /// Queues a request in place of the pane's older one, which is dropped without an answer. A caller that
  /// must answer the older request removes it before by withdraw(). Stops the picture of the pane that is
  /// being drawn, unless both requests are moving: frames must appear even if requests arrive faster than
  /// they are drawn.
  void ask(PaneRequest asked);
  /// Removes and returns a pane's waiting request; none if none waits.
  std::optional<PaneRequest> withdraw(const PaneName& name);
  /// Removes and returns a waiting request by its number; none if it does not wait.
  std::optional<PaneRequest> withdraw(std::uint64_t window, std::int64_t id);
  /// Stops the picture that is being drawn, if it answers this request. Returns whether it does.
  bool stop(std::uint64_t window, std::int64_t id);
  /// Waits for a request whose pane may be drawn, and removes and returns it. None once a stop is requested.
  std::optional<PaneRequest> next(const std::stop_token& stop);
  /// Records that the page has shown a frame.
  void shown(const PaneName& name, std::int64_t frame);
  /// The number of panes that share the time for drawing, at least 1: those with a moving request or with
  /// frames that are not shown yet.
  int moving_panes() const;
  /// Removes a pane and stops its picture. Returns its waiting request, if there is one.
  std::optional<PaneRequest> close(const PaneName& name);
  /// Removes all panes of a closed window and stops the window's picture, if one is being drawn.
  void close_window(std::uint64_t window);

 private:
  struct Pane {
    std::optional<PaneRequest> waiting;
    std::set<std::int64_t> in_flight;  ///< moving frames that the page has not shown yet
    std::uint64_t served = 0;          ///< number of the turn in which a request of this pane was drawn last
  };
  /// The request that next() returned last. It is being drawn until the next call.
  struct Drawn {
    PaneName name;
    std::int64_t id = 0;
    bool is_moving = false;
    std::stop_source stop;
  };
  std::map<PaneName, Pane>::iterator ready();
  /// Stops the picture that is being drawn if `test` is true for it. Returns whether it was.
  template <typename Test>
  bool stop_if(const Test& test);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::map<PaneName, Pane> panes_;
  std::optional<Drawn> drawn_;
  std::uint64_t turn_ = 0;
};

}  // namespace octotomy::planner::serve
