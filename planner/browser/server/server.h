// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "planner/browser/server/service.h"

namespace octotomy::planner::serve {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< address of the interface on which to listen
  int port = 0;                       ///< 0: a free one
  std::string token;
  std::optional<std::string> view_token;  ///< token of windows that only show the plan, if there are any
  /// Called once the server accepts callers, with the page's address including the token, and with the
  /// address of windows that only show the plan. The latter is empty if there are none.
  std::function<void(const std::string& url, const std::string& view_url)> ready;
};

/// A server in two steps. The constructor listens, so that an unavailable address is detected before other
/// work; callers wait until run().
class Server {
 public:
  /// Throws std::runtime_error if it cannot listen there.
  explicit Server(ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Serves the page, its files and its WebSockets until a stop is requested. May be called once. Invalid
  /// data from a caller end only the connection of that caller.
  void run(Service& service, Session& session, const std::stop_token& stop);

 private:
  struct Port;
  ServerOptions options_;
  std::unique_ptr<Port> port_;
};

}  // namespace octotomy::planner::serve
