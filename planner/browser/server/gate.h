// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Who may talk to the server: the page that was opened with the token, and nobody else's page.
namespace octotomy::planner::serve {

/// A request's target: "/file/a%20b.stl?token=1" is the path "/file/a b.stl" and the query token = 1.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;
};
/// Throws std::runtime_error where a percent sign is not followed by two hexadecimal digits, or a byte is 0.
Target parse_target(std::string_view text);

/// A file that was made, by the target "/file/TOKEN/report/report.html". The token stands in the path, so
/// that links within the report reach the files beside it. None for any other target.
struct FileTarget {
  std::string token, name;
};
std::optional<FileTarget> file_of(const Target& target);

/// What a request says of who sends it. Empty: it does not say it.
struct Caller {
  std::string host, origin, token;
};

/// 128 random bits in hexadecimal.
std::string new_token();
/// The token in a file that only its owner may read, or a new one that is written there: a server that is
/// started again with it is known to the pages that the earlier one opened. Throws std::runtime_error where
/// others may read the file, or it holds no token.
std::string token_in(const std::filesystem::path& path);

/// A page of another site can make a browser send requests here, by a name of its own for this machine, too:
/// it knows no token, and its Host or Origin is another.
class Gate {
 public:
  /// `hosts` are what a Host header may say: "127.0.0.1:8080". None: any, where the server was told to listen
  /// on other interfaces.
  Gate(std::string token, std::vector<std::string> hosts)
      : token_(std::move(token)), hosts_(std::move(hosts)) {}

  const std::string& token() const { return token_; }
  /// Why a file of the page itself, which holds nothing private, is refused; none: it is not.
  std::optional<std::string> refusal_of_host(const Caller& caller) const;
  /// Why a page is refused: Host or token is wrong, or it says another Origin than its Host.
  std::optional<std::string> refusal(const Caller& caller) const;
  /// The same of what acts: the Origin must be there.
  std::optional<std::string> refusal_of_action(const Caller& caller) const;

 private:
  std::string token_;
  std::vector<std::string> hosts_;
};

}  // namespace octotomy::planner::serve
