// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/service.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "planner/browser/server/plan_folders.h"
#include "planner/browser/server/slice_pane.h"
#include "planner/operation/picture/ray_pictures.h"
#include "planner/operation/table/fault.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

using Clock = std::chrono::steady_clock;

/// Time for one picture of every moving pane, of the 33 ms between two frames. The page needs the rest.
constexpr double most_round_ms = 24.0;
/// Time for a picture of a single moving pane. Shorter times would give more frames than a screen shows.
constexpr double most_frame_ms = 14.0;

/// The shortest time between two reports of progress.
constexpr std::chrono::milliseconds tell_every{100};

/// Whether a view's shading is computed along rays (ray_pictures.h).
bool is_ray_shading(const Json& said) {
  const std::vector<std::string> names = ray_picture_names();
  const Json shading = said.value("shading", Json());
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return shading == name; });
}

[[noreturn]] void refuse_viewer(const std::string& what) {
  throw voxel::Error(voxel::ErrorCode::Input,
                     "this window only shows the plan: it may not request '" + what + "'");
}

/// Runs work. Passes every exception to `refuse`, and ignores exceptions of `refuse`.
template <typename Work, typename Refuse>
void guarded(const Work& work, const Refuse& refuse) noexcept {
  try {
    try {
      work();
    } catch (const std::exception& error) {
      refuse(error);
    } catch (...) {
      refuse(InternalError("an error without a message"));
    }
  } catch (...) {
    // The refusal could not be sent either: the window is closed or memory is exhausted.
  }
}

}  // namespace

Service::Service(Session& session, LineOf line_of, std::optional<std::string> view_token)
    : session_(session), line_of_(std::move(line_of)), view_token_(std::move(view_token)) {
  for (const Lane lane : {Lane::Session, Lane::Evaluate, Lane::Certify, Lane::Overlap, Lane::Long})
    lanes_[lane] = std::make_unique<LaneQueue>(lane != Lane::Session && lane != Lane::Long);
  for (Drawing& drawing : drawings_)
    drawing.thread = std::jthread([&](const std::stop_token& stop) { draw(drawing, stop); });
}

Service::~Service() {
  lanes_.clear();
}

std::uint64_t Service::open_window(Send send_to, Access access) {
  const std::lock_guard lock(mutex_);
  const auto viewers = std::count_if(windows_.begin(), windows_.end(), [](const auto& window) {
    return window.second->access == Access::View;
  });
  if (access == Access::View && viewers >= most_viewers)
    throw voxel::Error(voxel::ErrorCode::Resource,
                       std::to_string(most_viewers) +
                           " windows look at this plan already, and no more may: close one of them");
  auto window = std::make_shared<Window>();
  window->send = std::move(send_to);
  window->access = access;
  windows_[++last_window_] = std::move(window);
  return last_window_;
}

void Service::close_window(std::uint64_t window) {
  {
    const std::lock_guard lock(mutex_);
    windows_.erase(window);
  }
  for (Drawing& drawing : drawings_) drawing.panes.close_window(window);
  for (const auto& [lane, queue] : lanes_) queue->close_window(window);
}

std::shared_ptr<Service::Window> Service::find(std::uint64_t window) {
  const std::lock_guard lock(mutex_);
  const auto found = windows_.find(window);
  return found == windows_.end() ? nullptr : found->second;
}

void Service::send(std::uint64_t window, Message message) {
  if (const auto found = find(window)) found->send(std::move(message));
}

void Service::tell_all(const std::string& name, const Json& said) {
  std::map<std::uint64_t, std::shared_ptr<Window>> all;
  {
    const std::lock_guard lock(mutex_);
    all = windows_;
  }
  const Message message = event(name, said);
  std::optional<Message> shortened;
  for (const auto& [id, window] : all) {
    if (window->access == Access::Edit) {
      window->send(message);
      continue;
    }
    if (!shortened) shortened = event(name, without_folders(said, known_folders()));
    window->send(*shortened);
  }
}

void Service::learn_folders() {
  if (!view_token_) return;
  std::vector<std::string> folders = folders_of(session_);
  const std::lock_guard lock(mutex_);
  // An earlier plan's work may still end with a message about its files.
  for (std::string& folder : folders_)
    if (std::find(folders.begin(), folders.end(), folder) == folders.end())
      folders.push_back(std::move(folder));
  std::stable_sort(folders.begin(), folders.end(),
                   [](const std::string& a, const std::string& b) { return a.size() > b.size(); });
  folders_ = std::move(folders);
}

std::vector<std::string> Service::known_folders() {
  const std::lock_guard lock(mutex_);
  return folders_;
}

void Service::tell_plan() {
  tell_all("plan", {{"plan_state", session_.state()}});
}

void Service::receive(std::uint64_t window, const std::string& text) {
  std::int64_t id = 0;
  guarded(
      [&] {
        Request request = parse_request(text);
        id = request.id;
        const auto sender = find(window);
        if (sender == nullptr) return;
        request.access = sender->access;
        take(window, std::move(request));
      },
      [&](const std::exception& error) { refuse(window, id, error); });
}

void Service::take(std::uint64_t window, Request request) {
  const Json& said = request.said;
  const auto pane = [&] { return PaneName{window, said.value("pane", 0)}; };
  if (request.what == "shown") {
    for (Drawing& drawing : drawings_) drawing.panes.shown(pane(), said.value("frame", std::int64_t{0}));
    return;
  }
  // Tests whether the connection still works.
  if (request.what == "alive") return send(window, answer_to(request.id, Json::object()));
  if (request.what == "cancel") {
    const std::int64_t target = said.value("target", std::int64_t{0});
    bool is_here = false;
    for (Drawing& drawing : drawings_) {
      const auto waited = drawing.panes.withdraw(window, target);
      if (waited) drop(*waited, "the picture was cancelled");
      is_here = waited || drawing.panes.stop(window, target) || is_here;
    }
    for (const auto& [lane, queue] : lanes_) is_here = queue->cancel(window, target) || is_here;
    return send(window, answer_to(request.id, {{"cancelled", is_here}}));
  }
  if (request.what == "close_pane") {
    for (Drawing& drawing : drawings_)
      if (const auto waited = drawing.panes.close(pane())) drop(*waited, "the pane was closed");
    return send(window, answer_to(request.id, Json::object()));
  }
  if (request.what == "pane") {
    const int number = said.value("pane", 0);
    if (number < 0 || number > 15) throw voxel::Error(voxel::ErrorCode::Input, "pane: must be 0 to 15");
    const bool is_moving = said.value("dragging", false);
    // A preview evaluates steps that are not in the plan, which may read other files.
    if (request.access == Access::View && said.contains("preview")) refuse_viewer("preview");
    const bool is_along_rays = said.value("kind", "view") != "slice" && is_ray_shading(said);
    // The older request of the pane is answered before the newer one can be drawn, so that a pane's answers
    // arrive in order. Pictures along rays have their own queue; requests of the pane in the other queue are
    // dropped.
    Drawing& other = drawings_[is_along_rays ? 0 : 1];
    if (const auto older = other.panes.close(pane())) drop(*older, "the pane shows another kind of picture");
    PaneQueue& panes = drawings_[is_along_rays ? 1 : 0].panes;
    if (const auto older = panes.withdraw(pane())) drop(*older, "a newer picture of the pane was requested");
    return panes.ask({pane(), std::move(request), is_moving});
  }
  const RequestKind& request_kind = find_request_kind(request.what);
  const bool certifies = request_kind.lane == Lane::Evaluate && said.value("certify", false);
  const auto of_window = find(window);
  if (of_window == nullptr) return;
  const bool may_edit = request.access == Access::Edit;
  if (!may_edit && !request_kind.may_view) refuse_viewer(request.what);
  if (of_window->waiting >= (may_edit ? most_waiting : most_waiting_of_viewer))
    throw voxel::Error(voxel::ErrorCode::Resource,
                       "too many requests wait for their answers: try again when some have arrived");
  ++of_window->waiting;
  const auto asked = std::make_shared<const Request>(std::move(request));
  const auto leave = std::shared_ptr<void>(nullptr, [of_window](void*) { --of_window->waiting; });
  lanes_.at(certifies ? Lane::Certify : request_kind.lane)
      ->put({window, asked->id,
             [this, window, asked, &request_kind, leave](const std::stop_token& stop) {
               answer(window, *asked, request_kind, stop);
             },
             [this, window, asked, leave] {
               refuse(window, asked->id, Stopped("a newer request took its place"));
             }});
}

void Service::answer(std::uint64_t window, const Request& request, const RequestKind& request_kind,
                     const std::stop_token& stop) {
  Clock::time_point told{};
  bool was_told = false;
  const Clock::time_point start = Clock::now();
  const auto shown = [&](Json said) {
    if (request.access == Access::View) said = without_folders(std::move(said), known_folders());
    return said;
  };
  guarded([&] { learn_folders(); }, [](const auto&) {});
  Watched watched{stop,
                  [&](const std::string& doing, double share) {
                    if (Clock::now() - told < tell_every) return;
                    told = Clock::now();
                    was_told = true;
                    const double spent_s = std::chrono::duration<double>(told - start).count();
                    send(window,
                         event("progress", {{"job", request.id},
                                            {"what", shown(doing)},
                                            {"share", share},
                                            {"left_s", share > 0.02 ? Json(spent_s * (1.0 - share) / share)
                                                                    : Json(nullptr)}}));
                  },
                  request.access};
  guarded(
      [&] {
        Json ok = request_kind.answer(session_, request.said, watched);
        if (request_kind.changes_plan) {
          learn_folders();
          Json state = session_.state();
          tell_all("plan", {{"plan_state", state}});
          if (ok.is_object()) state.update(ok);
          ok = std::move(state);
        }
        if (request_kind.lane == Lane::Evaluate) tell_all("objects", ok);
        if (request_kind.changes_objects) tell_plan();
        ok = shown(std::move(ok));
        if (request.what == "hello" && request.access == Access::Edit && view_token_)
          ok["view_token"] = *view_token_;
        send(window, answer_to(request.id, ok));
      },
      [&](const std::exception& error) { refuse(window, request.id, error); });
  if (was_told) guarded([&] { send(window, event("job_done", {{"job", request.id}})); }, [](const auto&) {});
}

void Service::refuse(std::uint64_t window, std::int64_t id, const std::exception& error) {
  const auto sender = find(window);
  if (sender == nullptr) return;
  if (sender->access == Access::Edit) return sender->send(refusal_to(id, error, line_of_));
  const auto line_of = [&](const std::string& text) {
    return line_of_(without_folders(text, known_folders()));
  };
  sender->send(refusal_to(id, error, line_of));
}

void Service::drop(const PaneQueue::PaneRequest& asked, const char* why) {
  refuse(asked.name.window, asked.request.id, Stopped(why));
}

void Service::draw(Drawing& drawing, const std::stop_token& over) {
  PaneQueue& panes = drawing.panes;
  auto& views = drawing.views;
  while (const auto asked = panes.next(over)) {
    const std::stop_token stop = asked->stop.get_token();
    const std::stop_callback end(over, [source = asked->stop]() mutable { source.request_stop(); });
    guarded(
        [&] {
          if (find(asked->name.window) == nullptr) {
            std::erase_if(views, [&](const auto& view) { return view.first.window == asked->name.window; });
            return;
          }
          if (asked->request.said.value("kind", "view") == "slice")
            return send(asked->name.window, draw_slice(session_, asked->request, stop));
          auto& view = views[asked->name];
          if (view == nullptr) view = std::make_unique<ViewPane>();
          send(asked->name.window,
               view->draw(session_, asked->request,
                          std::min(most_frame_ms, most_round_ms / panes.moving_panes()), stop));
        },
        [&](const std::exception& error) {
          panes.shown(asked->name, asked->request.id);
          refuse(asked->name.window, asked->request.id, error);
        });
    // Destroys the drawing state of closed windows.
    guarded(
        [&] { std::erase_if(views, [&](const auto& view) { return find(view.first.window) == nullptr; }); },
        [](const auto&) {});
  }
}

}  // namespace octotomy::planner::serve
