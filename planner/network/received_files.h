// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::planner {

struct ReceiveLimits {
  std::uint64_t object_bytes = std::uint64_t{4} << 30;  ///< largest size of an object
  std::uint64_t total_bytes = std::uint64_t{64} << 30;  ///< largest size of all objects together
};

/// An object that was received completely.
struct ReceivedFile {
  std::string name;  ///< the SHA-256 of its bytes, followed by ".dcm"
  std::uint64_t bytes = 0;
  std::string class_uid, instance_uid;
};

/// The folder into which objects are received. A file's name depends only on the object's bytes, so that no
/// peer can choose a path. May be used by several threads.
class ReceivedFiles {
 public:
  /// Creates the folder. Throws std::runtime_error with path and reason.
  ReceivedFiles(std::filesystem::path folder, const ReceiveLimits& limits);

  /// An object that is being received. Its file is removed unless finish() has succeeded.
  class Part {
   public:
    explicit Part(ReceivedFiles& owner);
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    ~Part();
    /// Appends bytes. Throws PeerError if a limit is exceeded, and std::runtime_error if the disk is full.
    void write(std::string_view bytes);
    /// Checks the object: it is a DICOM file, its attributes end within the file, and it has the given class
    /// and instance, unless these are empty. Then moves the file to its name. Throws PeerError if a check
    /// fails.
    ReceivedFile finish(const std::string& class_uid, const std::string& instance_uid);

   private:
    struct State;
    ReceivedFiles& owner_;
    std::unique_ptr<State> state_;
  };

  /// The received files, in the order in which they arrived.
  std::vector<ReceivedFile> files() const;

 private:
  std::filesystem::path folder_;
  ReceiveLimits limits_;
  mutable std::mutex mutex_;
  std::uint64_t bytes_ = 0, parts_ = 0;
  std::vector<ReceivedFile> files_;
};

}  // namespace octotomy::planner
