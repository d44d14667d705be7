// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "planner/table/bench.h"
#include "planner/table/object.h"

namespace octotomy::planner {

/// What earlier evaluations made, by the keys of what made it (step_keys()). Whoever evaluates a plan again
/// and again holds one: a step whose key is known is not evaluated. Answers are shared, never copied. All
/// members may be called from any thread.
class ObjectCache {
 public:
  /// Keeps so many answers; the one that was used longest ago goes first.
  explicit ObjectCache(std::size_t most = 512) : most_(most) {}

  struct Scan {
    LoadedScan loaded;
    ScanRecord record;
  };
  std::shared_ptr<const Object> object(const std::string& key) { return objects_.find(key, *this); }
  std::shared_ptr<const Scan> scan(const std::string& key) { return scans_.find(key, *this); }
  void keep(const std::string& key, const Object& object) {
    objects_.keep(key, std::make_shared<const Object>(object), *this);
  }
  void keep(const std::string& key, Scan scan) {
    scans_.keep(key, std::make_shared<const Scan>(std::move(scan)), *this);
  }
  /// The SHA-256 of a scan's files that have not changed since it was computed: `state` says their sizes and
  /// times.
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
    void keep(const std::string& key, std::shared_ptr<const Value> value, ObjectCache& cache) {
      const std::lock_guard lock(cache.mutex_);
      if (const auto found = values_.find(key); found != values_.end()) order_.erase(found->second.place);
      order_.push_front(key);
      values_.insert_or_assign(key, Entry{std::move(value), order_.begin()});
      while (order_.size() > cache.most_) {
        values_.erase(order_.back());
        order_.pop_back();
      }
    }

   private:
    struct Entry {
      std::shared_ptr<const Value> value;
      std::list<std::string>::iterator place;
    };
    std::map<std::string, Entry> values_;
    std::list<std::string> order_;  ///< used last first
  };

  std::size_t most_;
  mutable std::mutex mutex_;
  Shelf<Object> objects_;
  Shelf<Scan> scans_;
  std::map<std::string, std::string> sums_;
  Counts counts_;
};

/// The sizes and times of a scan's file, or of all the files of its folder: what changes where they change.
std::string state_of_path(const std::filesystem::path& path);

}  // namespace octotomy::planner
