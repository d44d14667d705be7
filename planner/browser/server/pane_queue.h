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

/// What is to be drawn next. Of each pane only the newest request waits; a moving pane waits, too, while
/// most_in_flight of its frames are not yet on the screen, so that a slow page gets fewer frames and no old
/// ones. Panes take turns. A picture that is being drawn is asked to stop once nobody wants it. All members
/// may be called from any thread.
class PaneQueue {
 public:
  static constexpr std::size_t most_in_flight = 2;

  struct Asked {
    PaneName name;
    Request request;
    bool is_moving = false;
    std::stop_source stop{};  ///< of drawing it
  };

  /// Lets a request wait in the place of an older one. Whoever must answer the older one calls withdraw()
  /// before: here it would go without a word. Stops the pane's picture that is drawn, unless both move:
  /// frames come also where requests do so faster.
  void ask(Asked asked);
  /// Takes a pane's waiting request out.
  std::optional<Asked> withdraw(const PaneName& name);
  /// The same by the request's number.
  std::optional<Asked> withdraw(std::uint64_t window, std::int64_t id);
  /// Stops a request that is drawn; whether it is.
  bool stop(std::uint64_t window, std::int64_t id);
  /// The next request whose pane is free; waits for one. None: stopped.
  std::optional<Asked> next(const std::stop_token& stop);
  /// The page shows a frame.
  void shown(const PaneName& name, std::int64_t frame);
  /// The panes that share the time of drawing: those with a moving request or frames in flight, at least 1.
  int moving_panes() const;
  /// Forgets a pane, and stops its picture that is drawn; what waited of it.
  std::optional<Asked> close(const PaneName& name);
  /// Forgets all panes of a window that has gone, and stops its picture that is drawn.
  void close_window(std::uint64_t window);

 private:
  struct Pane {
    std::optional<Asked> waiting;
    std::set<std::int64_t> in_flight;  ///< moving frames that the page has not shown yet
    std::uint64_t served = 0;          ///< when, by turns
  };
  /// What next() gave last, until it is called again.
  struct Drawn {
    PaneName name;
    std::int64_t id = 0;
    bool is_moving = false;
    std::stop_source stop;
  };
  std::map<PaneName, Pane>::iterator ready();
  /// Stops what is drawn if it passes a test; whether it does.
  template <typename Test>
  bool stop_if(const Test& test);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::map<PaneName, Pane> panes_;
  std::optional<Drawn> drawn_;
  std::uint64_t turn_ = 0;
};

}  // namespace octotomy::planner::serve
