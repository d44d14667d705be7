// SPDX-License-Identifier: AGPL-3.0-or-later
// Only this source includes Boost.Beast, which takes twelve seconds to compile. One thread transfers bytes;
// the service's threads compute answers and post them here.
#include "planner/browser/server/server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <filesystem>
#include <system_error>

#include "planner/browser/server/access_control.h"
#include "planner/browser/server/new_files.h"
#include "planner/browser/server/object_requests.h"
#include "planner/browser/server/page.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json_file.h"
#include "planner/result/report/drawn_page.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace fs = std::filesystem;
using Tcp = net::ip::tcp;

/// The largest message from a page. The longest ones are steps with a mask of many polygons.
constexpr std::uint64_t most_message_bytes = std::uint64_t{4} << 20;
constexpr std::uint32_t most_header_bytes = 16384;
/// The longest reason that a WebSocket's close frame can state.
constexpr std::size_t most_reason_bytes = 123;
/// While more bytes than this wait to be sent to a page, the page's messages are not read.
constexpr std::size_t most_unsent_bytes = std::size_t{64} << 20;
constexpr std::chrono::seconds patience{30};
constexpr std::chrono::seconds upload_patience{3600};
/// Pause before callers are accepted again, after file descriptors or memory were exhausted. Others may have
/// ended in the meantime.
constexpr std::chrono::milliseconds want_pause{100};

constexpr const char* page_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src "
    "'self'; "
    "worker-src 'self' blob:; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Content security policy of output files such as reports: they contain styles, pictures and one script that
/// draws them. No other script runs.
const std::string& file_policy() {
  static const std::string policy =
      "default-src 'none'; style-src 'unsafe-inline'; img-src data:; sandbox allow-scripts; base-uri "
      "'none'; frame-ancestors 'self'; script-src " +
      page_script_source();
  return policy;
}

struct Context {
  Service& service;
  Session& session;
  AccessControl access;
};

std::string text_of(beast::string_view text) {
  return {text.data(), text.size()};
}

template <typename Body>
Caller caller_of(const http::request<Body>& request, const Target& target) {
  const auto token = target.query.find("token");
  return {text_of(request[http::field::host]), text_of(request[http::field::origin]),
          token == target.query.end() ? "" : token->second};
}

/// The WebSocket of one window. It lives until its last pending operation has ended.
class Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(beast::tcp_stream stream, Context& context, Access access)
      : stream_(std::move(stream)), context_(context), access_(access) {}

  void run(const http::request<http::string_body>& request) {
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.read_message_max(most_message_bytes);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code failed) {
      if (failed) return;
      const std::weak_ptr<Socket> weak = self;
      const auto executor = self->stream_.get_executor();
      const auto send_to = [weak, executor](Message message) {
        net::post(executor, [weak, message = std::make_shared<Message>(std::move(message))] {
          if (const auto socket = weak.lock()) socket->send(message);
        });
      };
      try {
        self->window_ = self->context_.service.open_window(send_to, self->access_);
      } catch (const voxel::Error& error) {
        return self->turn_away(error.what());
      }
      self->read();
    });
  }

  ~Socket() {
    if (window_ != 0) context_.service.close_window(window_);
  }

 private:
  void read() {
    is_reading_ = true;
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code failed, std::size_t) {
      self->is_reading_ = false;
      if (failed) return self->close();
      if (self->stream_.got_text())
        self->context_.service.receive(self->window_, beast::buffers_to_string(self->buffer_.data()));
      self->buffer_.consume(self->buffer_.size());
      if (self->unsent_ < most_unsent_bytes) self->read();
    });
  }

  /// Ends the connection with a reason, which the page shows.
  void turn_away(const std::string& why) {
    is_closed_ = true;
    const beast::websocket::close_reason reason(beast::websocket::close_code::try_again_later,
                                                why.substr(0, most_reason_bytes));
    stream_.async_close(reason, [self = shared_from_this()](beast::error_code) {});
  }

  void send(const std::shared_ptr<Message>& message) {
    if (is_closed_) return;
    unsent_ += message->bytes.size();
    queue_.push_back(message);
    if (queue_.size() == 1) write();
  }

  void write() {
    stream_.binary(queue_.front()->is_binary);
    stream_.async_write(net::buffer(queue_.front()->bytes),
                        [self = shared_from_this()](beast::error_code failed, std::size_t) {
                          self->unsent_ -= self->queue_.front()->bytes.size();
                          self->queue_.pop_front();
                          if (failed) return self->close();
                          if (!self->queue_.empty()) self->write();
                          if (!self->is_reading_ && self->unsent_ < most_unsent_bytes) self->read();
                        });
  }

  void close() {
    if (is_closed_) return;
    is_closed_ = true;
    context_.service.close_window(std::exchange(window_, 0));
    beast::error_code ignored;
    beast::get_lowest_layer(stream_).socket().shutdown(Tcp::socket::shutdown_both, ignored);
    if (queue_.size() > 1) queue_.resize(1);
  }

  beast::websocket::stream<beast::tcp_stream> stream_;
  Context& context_;
  Access access_;
  beast::flat_buffer buffer_;
  std::deque<std::shared_ptr<Message>> queue_;
  std::size_t unsent_ = 0;
  std::uint64_t window_ = 0;
  bool is_reading_ = false, is_closed_ = false;
};

/// One HTTP connection. A request for a WebSocket passes it on to a Socket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Tcp::socket socket, Context& context) : stream_(std::move(socket)), context_(context) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(most_header_bytes);
    parser_->body_limit(most_upload_bytes);
    stream_.expires_after(patience);
    http::async_read_header(
        stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code failed, std::size_t) {
          if (!failed) self->guard([&] { self->take(); });
          if (failed == http::error::header_limit)
            self->refuse(
                http::status::request_header_fields_too_large,
                "the request's header is longer than " + std::to_string(most_header_bytes / 1024) + " KB");
        });
  }

 private:
  using Refusal = std::optional<std::string>;

  static http::status status_of(Fault fault) {
    if (fault == Fault::Internal) return http::status::internal_server_error;
    return fault == Fault::Resource ? http::status::insufficient_storage : http::status::bad_request;
  }

  template <typename Work>
  void guard(const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      refuse(status_of(fault_of(error)), message_of(error));
    }
  }

  void take() {
    const auto& request = parser_->get();
    const Target target = parse_target(std::string_view(request.target().data(), request.target().size()));
    const Caller caller = caller_of(request, target);
    const auto refused = [&](const Refusal& why) {
      if (why) refuse(http::status::forbidden, *why);
      return why.has_value();
    };
    if (target.path == "/upload" && request.method() == http::verb::post) {
      if (!refused(context_.access.refusal_of_action(caller, Access::Edit))) upload(target);
      return;
    }
    if (request.method() != http::verb::get || parser_->content_length().value_or(0) > 0) {
      if (!refused(context_.access.refusal(caller, Access::View)))
        refuse(http::status::method_not_allowed, "only GET is answered at this address");
      return;
    }
    if (target.path == "/socket") {
      if (refused(context_.access.refusal_of_action(caller, Access::View))) return;
      http::request<http::string_body> upgrade(request.base());
      if (!beast::websocket::is_upgrade(upgrade))
        return refuse(http::status::bad_request, "a WebSocket is expected");
      return std::make_shared<Socket>(std::move(stream_), context_, *context_.access.access_of(caller))
          ->run(upgrade);
    }
    if (auto named = file_of(target)) {
      if (!refused(context_.access.refusal({caller.host, caller.origin, named->token}, Access::Edit)))
        send_file(named->name);
      return;
    }
    const std::string path = target.path == "/" ? "/index.html" : target.path;
    if (refused(path == "/index.html" ? context_.access.refusal(caller, Access::View)
                                      : context_.access.refusal_of_host(caller)))
      return;
    for (const PageFile& file : page_files())
      if (file.path == path) return say(http::status::ok, std::string(file.type), std::string(file.bytes));
    refuse(http::status::not_found, "there is no such file");
  }

  template <typename Body>
  void set_fields(http::response<Body>& response, const std::string& type, const std::string& policy) {
    response.set(http::field::content_type, type);
    response.set("Content-Security-Policy", policy);
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set(http::field::cache_control, "no-store");
    response.keep_alive(false);
    response.prepare_payload();
  }

  template <typename Body>
  void write(const std::shared_ptr<http::response<Body>>& response) {
    stream_.expires_after(upload_patience);
    http::async_write(stream_, *response,
                      [self = shared_from_this(), response](beast::error_code, std::size_t) {
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
                      });
  }

  void say(http::status status, const std::string& type, const std::string& body) {
    auto response = std::make_shared<http::response<http::string_body>>(status, 11);
    response->body() = body;
    set_fields(*response, type, page_policy);
    write(response);
  }

  void refuse(http::status status, const std::string& why) {
    say(status, "text/plain; charset=utf-8", context_.service.line_of()(why));
  }

  void send_file(const std::string& name) {
    const fs::path folder = files_folder(context_.session);
    const fs::path path = context_.session.folders.need_within(folder / need_plain_name(name));
    auto response = std::make_shared<http::response<http::file_body>>(http::status::ok, 11);
    beast::error_code failed;
    if (fs::is_regular_file(path)) response->body().open(path.c_str(), beast::file_mode::scan, failed);
    if (failed || !response->body().is_open())
      return refuse(http::status::not_found, "there is no such file");
    const std::string ending = path.extension();
    const bool is_shown = ending == ".html" || ending == ".png" || ending == ".json";
    if (!is_shown) response->set(http::field::content_disposition, "attachment");
    set_fields(*response,
               ending == ".html"   ? "text/html; charset=utf-8"
               : ending == ".png"  ? "image/png"
               : ending == ".json" ? "application/json"
                                   : "application/octet-stream",
               file_policy());
    write(response);
  }

  /// Receives a file. Its bytes are written to disk as they arrive, into a hidden folder until the file is
  /// complete.
  void upload(const Target& target) {
    const auto named = target.query.find("name");
    const fs::path name = need_plain_name(named == target.query.end() ? "" : named->second);
    const fs::path folder = context_.session.working_folder() / "uploads";
    const fs::path place =
        context_.session.folders.need_within(name.has_parent_path() ? folder / name : unused(folder / name));
    arriving_.emplace(place.parent_path());
    const fs::path part = arriving_->hidden() / place.filename();
    upload_.emplace(std::move(*parser_));
    upload_->body_limit(most_upload_bytes);
    beast::error_code failed;
    upload_->get().body().open(part.c_str(), beast::file_mode::write_new, failed);
    if (failed) throw std::system_error(std::error_code(failed), place.string());
    stream_.expires_after(upload_patience);
    http::async_read(
        stream_, buffer_, *upload_, [self = shared_from_this(), place](beast::error_code ended, std::size_t) {
          self->upload_->get().body().close();
          self->guard([&] {
            if (ended) throw std::system_error(std::error_code(ended), place.string());
            self->arriving_->commit(place.filename());
            self->arriving_.reset();
            self->say(http::status::ok, "application/json", json_text(Json{{"path", place.string()}}));
          });
        });
  }

  beast::tcp_stream stream_;
  Context& context_;
  beast::flat_buffer buffer_{most_header_bytes * 4};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<NewFiles> arriving_;
  std::optional<http::request_parser<http::file_body>> upload_;
};

/// Whether a caller could not be accepted because a resource is exhausted that other connections will
/// release.
bool is_want(const beast::error_code& failed) {
  namespace errc = boost::system::errc;
  return failed == errc::too_many_files_open || failed == errc::too_many_files_open_in_system ||
         failed == errc::no_buffer_space || failed == errc::not_enough_memory;
}

/// Accepts the next caller. Each connection has a strand, so that messages posted from several threads are
/// sent in the order of posting. Without it, asio delays a message that a handler posts until the handler has
/// ended, and a message of another thread can overtake it.
void accept(Tcp::acceptor& acceptor, Context& context) {
  const net::any_io_executor strand = net::make_strand(acceptor.get_executor());
  acceptor.async_accept(strand, [&](beast::error_code failed, Tcp::socket socket) {
    if (failed == net::error::operation_aborted) return;
    if (is_want(failed)) {
      const auto timer = std::make_shared<net::steady_timer>(acceptor.get_executor(), want_pause);
      timer->async_wait([timer, &acceptor, &context](beast::error_code over) {
        if (!over) accept(acceptor, context);
      });
      return;
    }
    if (!failed) {
      beast::error_code ignored;
      socket.set_option(Tcp::no_delay(true), ignored);
      std::make_shared<Connection>(std::move(socket), context)->read();
    }
    accept(acceptor, context);
  });
}

}  // namespace

struct Server::Port {
  net::io_context io{1};
  Tcp::acceptor acceptor{io};
};

Server::Server(ServerOptions options) : options_(std::move(options)), port_(std::make_unique<Port>()) {
  beast::error_code failed;
  const auto address = net::ip::make_address(options_.address, failed);
  if (failed) throw std::runtime_error("--listen: '" + options_.address + "' is not an IP address");
  Tcp::acceptor& acceptor = port_->acceptor;
  try {
    const Tcp::endpoint endpoint(address, static_cast<unsigned short>(options_.port));
    acceptor.open(endpoint.protocol());
    acceptor.set_option(net::socket_base::reuse_address(true));
    acceptor.bind(endpoint);
    acceptor.listen();
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(options_.address + ":" + std::to_string(options_.port) +
                             ": cannot listen there: " + error.code().message() + "; choose another --port");
  }
}

Server::~Server() = default;

void Server::run(Service& service, Session& session, const std::stop_token& stop) {
  const Tcp::endpoint endpoint = port_->acceptor.local_endpoint();
  const net::ip::address address = endpoint.address();
  const std::string port = std::to_string(endpoint.port());
  const std::string name = address.is_v6() ? "[" + options_.address + "]" : options_.address;
  std::vector<std::string> hosts{name + ":" + port};
  if (address.is_loopback()) hosts.push_back("localhost:" + port);
  if (address.is_unspecified()) hosts.clear();
  Context context{service, session, AccessControl(options_.token, hosts, options_.view_token)};
  // Connections refer to `context`. Destroying `opened` first destroys them while it still exists.
  const std::unique_ptr<Port> opened = std::move(port_);
  net::io_context& io = opened->io;
  accept(opened->acceptor, context);
  const std::stop_callback end(stop, [&io] { io.stop(); });
  if (options_.ready) {
    const std::string page =
        "http://" + (address.is_unspecified() ? std::string("127.0.0.1") : name) + ":" + port + "/?token=";
    options_.ready(page + options_.token, options_.view_token ? page + *options_.view_token : "");
  }
  while (!stop.stop_requested() && !io.stopped()) {
    try {
      io.run();
    } catch (const std::exception&) {
      // The connection of the failed handler has ended. The error is not logged, because memory may be
      // exhausted.
    }
  }
}

}  // namespace octotomy::planner::serve
