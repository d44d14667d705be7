// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/browser/server/lane_queue.h"
#include "planner/browser/server/message.h"
#include "planner/browser/server/pane_queue.h"
#include "planner/browser/server/requests.h"
#include "planner/browser/server/session.h"
#include "planner/browser/server/view_pane.h"

namespace octotomy::planner::serve {

/// The windows of one session, and the threads that handle their requests: one for views and slices, one for
/// pictures along rays, which take longer, and one each for edits, evaluation, certificates, overlaps and
/// long tasks. Every request of an open window is answered exactly once, even if it fails. Only "shown" has
/// no answer. All members may be called from any thread.
class Service {
 public:
  /// Sends a message to a window's socket; may be called from any thread and must not block.
  using Send = std::function<void(Message message)>;

  /// `line_of` formats error messages. Windows that may edit receive `view_token`, if there is one, to make
  /// links for windows that only show the plan.
  Service(Session& session, LineOf line_of, std::optional<std::string> view_token = {});
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  const LineOf& line_of() const { return line_of_; }
  /// Adds a window and returns its number. With Access::View, the window receives all messages without folders
  /// and may send only requests with `may_view`. Throws voxel::Error, Resource, if most_viewers such windows are
  /// open.
  std::uint64_t open_window(Send send, Access access);
  void close_window(std::uint64_t window);
  /// Handles a message of a window. The answer is sent later, from another thread.
  void receive(std::uint64_t window, const std::string& text);

 private:
  /// Largest number of requests of a window that wait for their answers. A page sends far fewer.
  static constexpr int most_waiting = 500;
  /// The same for a window that only shows the plan, so that it cannot delay windows that edit.
  static constexpr int most_waiting_of_viewer = 8;
  /// The largest number of windows that may only look; each keeps the pictures of its panes.
  static constexpr int most_viewers = 16;
  struct Window {
    Send send;
    Access access = Access::Edit;
    std::atomic<int> waiting{0};
  };
  std::shared_ptr<Window> find(std::uint64_t window);
  void send(std::uint64_t window, Message message);
  /// Sends an event to all windows. Those that only show the plan receive it without folders.
  void tell_all(const std::string& name, const Json& said);
  void tell_plan();
  /// Stores the folders that the open plan names, so that refusals are shortened without waiting for the
  /// session. Does nothing where no window may only look.
  void learn_folders();
  std::vector<std::string> known_folders();
  void take(std::uint64_t window, Request request);
  void answer(std::uint64_t window, const Request& request, const RequestKind& request_kind,
              const std::stop_token& stop);
  void refuse(std::uint64_t window, std::int64_t id, const std::exception& error);
  /// Answers a waiting request for a picture that will not be drawn; `why` is the reason.
  void drop(const PaneQueue::PaneRequest& asked, const char* why);
  /// The queue, state and thread that draw one kind of picture.
  struct Drawing {
    PaneQueue panes;
    std::map<PaneName, std::unique_ptr<ViewPane>> views{};  ///< only `thread` uses them
    std::jthread thread{};
  };
  void draw(Drawing& drawing, const std::stop_token& over);

  Session& session_;
  LineOf line_of_;
  std::optional<std::string> view_token_;
  std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Window>> windows_;
  std::uint64_t last_window_ = 0;
  std::vector<std::string> folders_;  ///< of the plans opened so far, the longest first
  std::map<Lane, std::unique_ptr<LaneQueue>> lanes_;
  std::array<Drawing, 2> drawings_;  ///< first views and slices, then pictures along rays
};

}  // namespace octotomy::planner::serve
