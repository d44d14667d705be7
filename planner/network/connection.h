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

/// The other side does not answer, violates the protocol, exceeds a limit, or refuses a request.
struct PeerError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Files for TLS 1.2 or later, all PEM. A client checks the server's certificate and host name against
/// `authorities`; without them, against those of the system. A server shows `certificate`, whose private key
/// is `key`. If it has `authorities`, it accepts only clients whose certificates they have signed.
struct TlsFiles {
  std::filesystem::path certificate = {}, key = {}, authorities = {};
};

/// A TCP connection, plain or with TLS. Waiting for the other side ends at the deadline.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// Connects to a host. Throws PeerError with host, port and reason.
  Connection(const std::string& host, int port, const std::optional<TlsFiles>& tls,
             std::chrono::seconds timeout);
  Connection(Connection&&) noexcept;
  ~Connection();

  /// Reads or writes the whole block. Both throw PeerError if the other side closes the connection or the
  /// deadline passes.
  void read(char* bytes, std::size_t count);
  void write(std::string_view bytes);
  void set_deadline(std::chrono::milliseconds from_now);
  /// The other side's address, as messages show it.
  const std::string& peer() const;

 private:
  friend class Listener;
  struct State;
  explicit Connection(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Accepts connections on a port; with port 0, on any free one.
class Listener {
 public:
  /// Listens on an address. Throws std::runtime_error with address, port and reason, or with the file of
  /// `tls` that cannot be read.
  Listener(const std::string& address, int port, const std::optional<TlsFiles>& tls);
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  int port() const;
  /// Waits for the next connection. Its TLS handshake is still to be made by handshake(). None if no
  /// connection arrives within `wait`. Throws PeerError.
  std::optional<Connection> accept(std::chrono::milliseconds wait);
  /// Makes the TLS handshake of an accepted connection; does nothing without TLS. Throws PeerError. May be
  /// called from any thread.
  void handshake(Connection& connection) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace octotomy::planner
