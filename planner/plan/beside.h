// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>

namespace octotomy::planner {

/// Pieces of work that go on beside the caller's, on the threads that it leaves idle; with one thread they
/// wait until they are waited for. The end stops them and waits for that. Not for several threads at once.
class Beside {
 public:
  /// `stop` stops the pieces, too.
  explicit Beside(const std::stop_token& stop);
  ~Beside();
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  /// Begins a piece, which heeds the token that it is given. Pieces are numbered from 0 and begun in order.
  /// Precondition: not within apart().
  void begin(std::function<void(const std::stop_token&)> piece);
  /// Waits for a piece, at work on the others meanwhile; throws what the piece threw.
  void wait(std::size_t piece);
  /// Runs work of the caller whose parallel loops take up no piece while they wait.
  void apart(const std::function<void()>& work) const;

 private:
  struct Pieces;
  std::unique_ptr<Pieces> pieces_;
};

}  // namespace octotomy::planner
