// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// The other side does not answer, violates the protocol, exceeds a limit, or refuses.
struct PeerError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// TLS 1.2 or later. A client verifies the server's certificate and host against `authorities`, PEM, or else the
/// system's; a server shows `certificate` with `key` and, if `authorities` are given, accepts only clients that they
/// signed.
struct TlsFiles {
  std::filesystem::path certificate = {}, key = {}, authorities = {};
};

/// A TCP connection, plain or by TLS. Every wait ends at the deadline.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// Throws PeerError with host, port and reason.
  Connection(const std::string& host, int port, const std::optional<TlsFiles>& tls,
             std::chrono::seconds timeout);
  Connection(Connection&&) noexcept;
  ~Connection();

  /// Reads and writes whole blocks. Throw PeerError if the other side closes, or the deadline passes.
  void read(char* bytes, std::size_t count);
  void write(std::string_view bytes);
  void set_deadline(std::chrono::milliseconds from_now);
  /// The other side's address, for messages.
  const std::string& peer() const;

 private:
  friend class Listener;
  struct State;
  explicit Connection(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Accepts connections on a port; 0 is any free one.
class Listener {
 public:
  /// Throws std::runtime_error with address, port and reason, or the file of `tls` that cannot be read.
  Listener(const std::string& address, int port, const std::optional<TlsFiles>& tls);
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  int port() const;
  /// The next connection, before its TLS handshake; none after `wait`. Throws PeerError.
  std::optional<Connection> accept(std::chrono::milliseconds wait);
  /// The TLS handshake, if the listener has one. Throws PeerError. May be called by any thread.
  void handshake(Connection& connection) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace octotomy::planner
