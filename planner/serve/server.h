// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "planner/serve/service.h"

namespace octotomy::planner::serve {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< of the interface to listen on
  int port = 0;                       ///< 0: a free one
  std::string token;
  /// Called once with the page's address, token included, when it can be opened.
  std::function<void(const std::string& url)> ready;
};

/// Serves the page, its files and its WebSockets until the stop token is set. What one caller sends ends at
/// most that caller's connection. Throws std::runtime_error where it cannot listen there.
void serve(Service& service, Desk& desk, const ServerOptions& options, const std::stop_token& stop);

}  // namespace octotomy::planner::serve
