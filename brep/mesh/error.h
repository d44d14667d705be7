// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace octotomy::brep {

/// The kind of an error. Exit statuses follow from it, never from a message.
enum class ErrorCode {
  Input,      ///< a file or number from outside is wrong
  Geometry,   ///< the data are sound, but the operation has no answer on them
  Cancelled,  ///< a stop token was set
  Resource,   ///< memory, disk or time gave out
};

/// The mesh kernel's error: a code and a message that names the place, the cause and what to do next. A
/// broken precondition is no Error but std::invalid_argument.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// A stop token was set: there is no answer because nobody waits for one, not because none exists.
struct Stopped : Error {
  explicit Stopped(const std::string& message) : Error(ErrorCode::Cancelled, message) {}
};

}  // namespace octotomy::brep
