// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace octotomy::planner {

/// Owns a file descriptor and closes it.
class ConnectionSocket {
 public:
  explicit ConnectionSocket(int number = -1) : number_(number) {}
  ConnectionSocket(ConnectionSocket&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  ConnectionSocket& operator=(ConnectionSocket&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~ConnectionSocket() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

namespace {

using Context = std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)>;
using Session = std::unique_ptr<SSL, decltype(&SSL_free)>;

std::string tls_reason() {
  std::array<char, 256> text{};
  const unsigned long code = ERR_peek_last_error();
  ERR_clear_error();
  if (code == 0) return "the other side closed the connection";
  ERR_error_string_n(code, text.data(), text.size());
  return text.data();
}

void need_file(bool is_read, const std::filesystem::path& path, const char* what) {
  if (!is_read)
    throw std::runtime_error(path.string() + ": cannot be read as " + what + ", PEM: " + tls_reason());
}

Context context_of(const TlsFiles& files, bool is_server) {
  Context context(SSL_CTX_new(is_server ? TLS_server_method() : TLS_client_method()), &SSL_CTX_free);
  if (!context) throw std::runtime_error("TLS cannot be started: " + tls_reason());
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION);
  if (!files.certificate.empty())
    need_file(SSL_CTX_use_certificate_chain_file(context.get(), files.certificate.c_str()) == 1,
              files.certificate, "a certificate");
  if (!files.key.empty())
    need_file(SSL_CTX_use_PrivateKey_file(context.get(), files.key.c_str(), SSL_FILETYPE_PEM) == 1, files.key,
              "the certificate's private key");
  if (!files.authorities.empty())
    need_file(SSL_CTX_load_verify_locations(context.get(), files.authorities.c_str(), nullptr) == 1,
              files.authorities, "certificates of authorities");
  else if (!is_server)
    SSL_CTX_set_default_verify_paths(context.get());
  const bool verifies = !is_server || !files.authorities.empty();
  SSL_CTX_set_verify(context.get(),
                     verifies ? SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT : SSL_VERIFY_NONE, nullptr);
  return context;
}

void make_ready(int socket) {
  ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) | O_NONBLOCK);
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

std::string address_text(const sockaddr* address, socklen_t length) {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  if (::getnameinfo(address, length, host.data(), host.size(), port.data(), port.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return "an unknown address";
  return std::string(host.data()) + ":" + port.data();
}

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses addresses_of(const std::string& host, int port, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags;
  addrinfo* found = nullptr;
  const int status = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (status != 0) throw PeerError(host + ": " + ::gai_strerror(status));
  return {found, &::freeaddrinfo};
}

}  // namespace

struct Connection::State {
  ConnectionSocket socket{};
  Context context{nullptr, &SSL_CTX_free};
  Session session{nullptr, &SSL_free};
  Clock::time_point deadline = Clock::now() + std::chrono::seconds(30);
  std::string peer = {};

  void wait(short events) const {
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (left <= 0) throw PeerError(peer + ": does not answer in time");
      pollfd one{socket.number(), events, 0};
      const int ready = ::poll(&one, 1, static_cast<int>(std::min<long long>(left, 1000)));
      if (ready > 0) return;
      if (ready < 0 && errno != EINTR) throw PeerError(peer + ": " + std::strerror(errno));
    }
  }

  /// Waits until the socket can be read or written, whichever TLS needs after an operation with this result.
  /// Throws for other results.
  void wait_for_tls(int result) const {
    const int error = SSL_get_error(session.get(), result);
    if (error == SSL_ERROR_WANT_READ) return wait(POLLIN);
    if (error == SSL_ERROR_WANT_WRITE) return wait(POLLOUT);
    throw PeerError(peer + ": TLS: " + tls_reason());
  }

  void begin_tls(SSL_CTX* of, bool is_server, const std::string& host) {
    session.reset(SSL_new(of));
    if (!session || SSL_set_fd(session.get(), socket.number()) != 1)
      throw PeerError(peer + ": TLS: " + tls_reason());
    if (!is_server) {
      X509_VERIFY_PARAM* const wanted = SSL_get0_param(session.get());
      if (X509_VERIFY_PARAM_set1_ip_asc(wanted, host.c_str()) != 1) {
        ERR_clear_error();
        SSL_set1_host(session.get(), host.c_str());
        SSL_set_tlsext_host_name(session.get(), host.c_str());
      }
    }
    for (;;) {
      const int result = is_server ? SSL_accept(session.get()) : SSL_connect(session.get());
      if (result == 1) return;
      wait_for_tls(result);
    }
  }
};

Connection::Connection(std::unique_ptr<State> state) : state_(std::move(state)) {}
Connection::Connection(Connection&&) noexcept = default;
Connection::~Connection() = default;

Connection::Connection(const std::string& host, int port, const std::optional<TlsFiles>& tls,
                       std::chrono::seconds timeout)
    : state_(std::make_unique<State>()) {
  ::signal(SIGPIPE, SIG_IGN);
  state_->deadline = Clock::now() + timeout;
  state_->peer = host + ":" + std::to_string(port);
  const Addresses found = addresses_of(host, port, 0);
  int error = EHOSTUNREACH;
  for (const addrinfo* each = found.get(); each != nullptr && error != 0; each = each->ai_next) {
    state_->socket = ConnectionSocket(::socket(each->ai_family, each->ai_socktype, each->ai_protocol));
    if (state_->socket.number() < 0) continue;
    make_ready(state_->socket.number());
    error = ::connect(state_->socket.number(), each->ai_addr, each->ai_addrlen) == 0 ? 0 : errno;
    if (error != EINPROGRESS) continue;
    state_->wait(POLLOUT);
    socklen_t size = sizeof error;
    ::getsockopt(state_->socket.number(), SOL_SOCKET, SO_ERROR, &error, &size);
  }
  if (error != 0) throw PeerError(state_->peer + ": no connection: " + std::strerror(error));
  if (!tls) return;
  state_->context = context_of(*tls, false);
  state_->begin_tls(state_->context.get(), false, host);
}

void Connection::read(char* bytes, std::size_t count) {
  while (count > 0) {
    const int most = static_cast<int>(std::min<std::size_t>(count, 1 << 20));
    if (state_->session) {
      const int got = SSL_read(state_->session.get(), bytes, most);
      if (got <= 0) {
        state_->wait_for_tls(got);
        continue;
      }
      bytes += got;
      count -= static_cast<std::size_t>(got);
      if (Clock::now() > state_->deadline) throw PeerError(state_->peer + ": does not answer in time");
      continue;
    }
    state_->wait(POLLIN);
    const ssize_t got = ::recv(state_->socket.number(), bytes, static_cast<std::size_t>(most), 0);
    if (got == 0) throw PeerError(state_->peer + ": closed the connection");
    if (got < 0 && errno != EAGAIN && errno != EINTR)
      throw PeerError(state_->peer + ": " + std::strerror(errno));
    if (got < 0) continue;
    bytes += got;
    count -= static_cast<std::size_t>(got);
  }
}

void Connection::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t most = std::min<std::size_t>(bytes.size(), 1 << 20);
    if (state_->session) {
      const int put = SSL_write(state_->session.get(), bytes.data(), static_cast<int>(most));
      if (put <= 0)
        state_->wait_for_tls(put);
      else
        bytes.remove_prefix(static_cast<std::size_t>(put));
      continue;
    }
    state_->wait(POLLOUT);
    const ssize_t put = ::send(state_->socket.number(), bytes.data(), most, MSG_NOSIGNAL);
    if (put < 0 && errno != EAGAIN && errno != EINTR)
      throw PeerError(state_->peer + ": " + std::strerror(errno));
    if (put > 0) bytes.remove_prefix(static_cast<std::size_t>(put));
  }
}

void Connection::set_deadline(std::chrono::milliseconds from_now) {
  state_->deadline = Clock::now() + from_now;
}

const std::string& Connection::peer() const {
  return state_->peer;
}

struct Listener::State {
  ConnectionSocket socket{};
  Context context{nullptr, &SSL_CTX_free};
};

Listener::Listener(const std::string& address, int port, const std::optional<TlsFiles>& tls)
    : state_(std::make_unique<State>()) {
  ::signal(SIGPIPE, SIG_IGN);
  if (tls) state_->context = context_of(*tls, true);
  const Addresses found = addresses_of(address, port, AI_PASSIVE);
  state_->socket = ConnectionSocket(::socket(found->ai_family, found->ai_socktype, found->ai_protocol));
  const int yes = 1;
  ::setsockopt(state_->socket.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(state_->socket.number(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(state_->socket.number(), 64) != 0)
    throw std::runtime_error(address + ":" + std::to_string(port) +
                             ": no connections can be accepted there: " + std::strerror(errno));
  make_ready(state_->socket.number());
}

Listener::~Listener() = default;

int Listener::port() const {
  sockaddr_storage own{};
  socklen_t length = sizeof own;
  ::getsockname(state_->socket.number(), reinterpret_cast<sockaddr*>(&own), &length);
  return ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(own).sin6_port
                                         : reinterpret_cast<const sockaddr_in&>(own).sin_port);
}

std::optional<Connection> Listener::accept(std::chrono::milliseconds wait) {
  pollfd one{state_->socket.number(), POLLIN, 0};
  if (::poll(&one, 1, static_cast<int>(wait.count())) <= 0) return std::nullopt;
  sockaddr_storage other{};
  socklen_t length = sizeof other;
  ConnectionSocket socket(::accept(state_->socket.number(), reinterpret_cast<sockaddr*>(&other), &length));
  if (socket.number() < 0) return std::nullopt;
  make_ready(socket.number());
  auto made = std::make_unique<Connection::State>();
  made->socket = std::move(socket);
  made->peer = address_text(reinterpret_cast<const sockaddr*>(&other), length);
  return Connection(std::move(made));
}

void Listener::handshake(Connection& connection) const {
  if (state_->context) connection.state_->begin_tls(state_->context.get(), true, "");
}

}  // namespace octotomy::planner
