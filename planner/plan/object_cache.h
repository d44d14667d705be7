// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// Results of earlier evaluations by their keys (step_keys()). With it, a caller that evaluates a plan
/// repeatedly does not evaluate a step again whose key is stored. Results are shared, not copied. All members
/// may be called from any thread.
class ObjectCache {
 public:
  /// Stores at most `most` objects and `most` scans. Each kind may take `most_bytes` bytes of memory, except
  /// that the newest result always stays. The least recently used ones are removed first.
  explicit ObjectCache(std::size_t most = 512, std::uint64_t most_bytes = std::uint64_t{2} << 30)
      : most_(most), most_bytes_(most_bytes) {}

  struct Scan {
    LoadedScan loaded;
    ScanRecord record;
  };
  std::shared_ptr<const Object> object(const std::string& key) { return objects_.find(key, *this); }
  std::shared_ptr<const Scan> scan(const std::string& key) { return scans_.find(key, *this); }
  void keep(const std::string& key, const Object& object) {
    objects_.keep(key, std::make_shared<const Object>(object), bytes_of(object), *this);
  }
  void keep(const std::string& key, Scan scan) {
    const std::uint64_t bytes = bytes_of(scan);
    scans_.keep(key, std::make_shared<const Scan>(std::move(scan)), bytes, *this);
  }
  /// Memory of a result, including parts that are computed only when needed. Memory that several results
  /// share counts in each.
  static std::uint64_t bytes_of(const Object& object);
  static std::uint64_t bytes_of(const Scan& scan);
  /// The stored SHA-256 of a scan's files. None if it is not stored for this `state`, which contains the
  /// files' sizes and times.
  std::optional<std::string> sum(const std::string& state) const;
  void keep_sum(const std::string& state, const std::string& sha256);

  struct Counts {
    std::size_t found = 0, missed = 0;
  };
  Counts counts() const;

 private:
  template <typename Value>
  class Shelf {
   public:
    std::shared_ptr<const Value> find(const std::string& key, ObjectCache& cache) {
      const std::lock_guard lock(cache.mutex_);
      const auto found = values_.find(key);
      ++(found == values_.end() ? cache.counts_.missed : cache.counts_.found);
      if (found == values_.end()) return nullptr;
      order_.splice(order_.begin(), order_, found->second.place);
      return found->second.value;
    }
    void keep(const std::string& key, std::shared_ptr<const Value> value, std::uint64_t bytes,
              ObjectCache& cache) {
      const std::lock_guard lock(cache.mutex_);
      drop(key);
      order_.push_front(key);
      values_.emplace(key, Entry{std::move(value), bytes, order_.begin()});
      bytes_ += bytes;
      while (order_.size() > cache.most_ || (bytes_ > cache.most_bytes_ && order_.size() > 1))
        drop(std::string(order_.back()));
    }

   private:
    struct Entry {
      std::shared_ptr<const Value> value;
      std::uint64_t bytes = 0;
      std::list<std::string>::iterator place;
    };
    void drop(const std::string& key) {
      const auto found = values_.find(key);
      if (found == values_.end()) return;
      bytes_ -= found->second.bytes;
      order_.erase(found->second.place);
      values_.erase(found);
    }
    std::map<std::string, Entry> values_;
    std::list<std::string> order_;  ///< most recently used first
    std::uint64_t bytes_ = 0;
  };

  std::size_t most_;
  std::uint64_t most_bytes_;
  mutable std::mutex mutex_;
  Shelf<Object> objects_;
  Shelf<Scan> scans_;
  std::map<std::string, std::string> sums_;
  Counts counts_;
};

/// A text with size and time of a scan's file, or of all files in its folder. It changes if a file does.
std::string state_of_path(const std::filesystem::path& path);

}  // namespace octotomy::planner
