// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A text is stored as its difference from its parent's: the lengths of the unchanged beginning and end, and
// the bytes between them. Every 64th text is stored whole, so that reading one takes at most 64 reads. A
// change of state consists of
//   1 one transaction of the database: the edit and the current state; 2 the plan's file, as a whole; 3 a
//   record of the checksum of the file written in step 2.
// Steps 2 and 3, and every opening of the history, make file and state agree (settle()). The next process
// does this for a process that was killed after step 1. If the file's checksum is the recorded one but not
// the current state's, step 2 is due. If it is neither, another program wrote the file, and its text becomes
// an edit. The steps of two writers may interleave in any order: tests/planner/plan/history_model_test.cpp
// tests all orders.
//
// The journal is deleted at each commit, so that between edits the history is complete in one file and can be
// copied. A write-ahead log would make edits a third faster but store the newest ones in a second file.
#include "planner/plan/history.h"

#include <algorithm>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <sqlite3.h>
#include <stdexcept>
#include <sys/stat.h>
#include <tuple>
#include <unistd.h>
#include <utility>

#include "planner/operation/file/output_path.h"
#include "planner/operation/table/control_character.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/plan/sha256.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

constexpr int layout = 1;
constexpr int whole_every = 64;
constexpr int busy_ms = 5000;
constexpr std::size_t longest_name = 200;  // longest name of a branch or a version, in bytes

using Access = PlanHistory::Access;

constexpr const char* tables = R"(
  CREATE TABLE edits (id INTEGER PRIMARY KEY, parent INTEGER REFERENCES edits, what TEXT NOT NULL,
    made_at TEXT NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%SZ', 'now')), sum TEXT NOT NULL,
    depth INTEGER NOT NULL, head INTEGER NOT NULL, tail INTEGER NOT NULL, middle BLOB NOT NULL);
  CREATE TABLE branches (name TEXT PRIMARY KEY, tip INTEGER NOT NULL REFERENCES edits) WITHOUT ROWID;
  CREATE TABLE versions (name TEXT PRIMARY KEY, edit INTEGER NOT NULL REFERENCES edits) WITHOUT ROWID;
  CREATE TABLE state (current INTEGER NOT NULL, branch TEXT NOT NULL, written TEXT NOT NULL);
)";

/// Throws: the folder cannot be written, and the newest states are not in the history's file but in files
/// beside it.
[[noreturn]] void refuse_read_only(const fs::path& path) {
  throw std::runtime_error(path.string() +
                           ": its newest states lie in files beside it, which need a folder that can be "
                           "written: copy the plan and all files whose names begin with " +
                           path.filename().string() + " to such a folder");
}

[[noreturn]] void fail(sqlite3* database, const fs::path& path) {
  const int code = sqlite3_errcode(database) & 0xff;
  const std::string what = path.string() + ": " + sqlite3_errmsg(database);
  if (code == SQLITE_FULL || code == SQLITE_IOERR)
    throw voxel::Error(voxel::ErrorCode::Resource, what + ": is the disk full?");
  if (code == SQLITE_NOMEM) throw voxel::Error(voxel::ErrorCode::Resource, what);
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT)
    throw std::runtime_error(path.string() +
                             ": is not the history of a plan: move it away, and a new one is begun");
  if (code == SQLITE_READONLY) refuse_read_only(path);
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
    throw std::runtime_error(path.string() + ": another program is writing this plan's history: try again");
  throw std::runtime_error(what);
}

struct Bytes {
  std::string bytes;
};

/// A SQL statement with its values, and the rows that it returns.
class Query {
 public:
  Query(sqlite3* database, const fs::path& path, const char* text) : database_(database), path_(path) {
    if (sqlite3_prepare_v2(database, text, -1, &statement_, nullptr) != SQLITE_OK) fail(database, path);
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;
  Query(Query&& other) noexcept
      : database_(other.database_),
        path_(other.path_),
        statement_(std::exchange(other.statement_, nullptr)),
        bound_(other.bound_) {}

  /// Binds the next value.
  void with(std::int64_t value) { sqlite3_bind_int64(statement_, ++bound_, value); }
  void with(const std::string& text) {
    sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
  }
  void with(const std::optional<std::int64_t>& value) {
    if (value) return with(*value);
    sqlite3_bind_null(statement_, ++bound_);
  }
  void with(const Bytes& bytes) {
    sqlite3_bind_blob(statement_, ++bound_, bytes.bytes.data(), static_cast<int>(bytes.bytes.size()),
                      SQLITE_TRANSIENT);
  }
  /// Moves to the next row. Returns false if there is none.
  bool next() {
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) fail(database_, path_);
    return false;
  }
  std::int64_t number(int column) { return sqlite3_column_int64(statement_, column); }
  bool is_null(int column) { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  std::string text(int column) {
    const void* bytes = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes == nullptr ? "" : std::string(static_cast<const char*>(bytes), size);
  }

 private:
  sqlite3* database_;
  const fs::path& path_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

/// A path as part of a URI: escapes the three characters that would end or change it.
std::string uri_of(const fs::path& path) {
  std::string uri;
  for (const char letter : path.string())
    if (letter == '%' || letter == '?' || letter == '#')
      uri += letter == '%' ? "%25" : letter == '?' ? "%3f" : "%23";
    else
      uri += letter;
  return uri;
}

std::string read_text(const fs::path& path) {
  std::ifstream file = voxel::opened(path);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

class PlanHistory::Database {
 public:
  Database(const fs::path& plan, Access access)
      : plan_(voxel::behind_links(fs::absolute(plan))), path_(path_of(plan_)) {
    try {
      access == Access::Read ? open_to_read() : open_to_write();
    } catch (...) {
      sqlite3_close(database_);
      throw;
    }
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::int64_t record(const std::string& text, const std::string& what) {
    if (sha256_of(text) == sum_of(current_)) return current_;
    change([&] {
      add(text, what, current_);
      query("UPDATE branches SET tip = ? WHERE name = ?", current_, branch_).next();
    });
    return current_;
  }
  void need_no_other_writer() {
    Query state = query("SELECT current, branch, written FROM state");
    state.next();
    const std::string again = ": open it again and repeat the change";
    if (state.number(0) != current_ || state.text(1) != branch_)
      throw OtherWriter(plan_.string() + ": another program changed this plan, which is now at edit " +
                        std::to_string(state.number(0)) + again);
    const std::string sum = sha256_of(read_text(plan_));
    if (sum != state.text(2) && sum != sum_of(current_))
      throw OtherWriter(plan_.string() + ": another program wrote this file" + again);
  }
  bool undo() {
    const std::optional<std::int64_t> parent = parent_of(current_);
    if (parent) change([&] { current_ = *parent; });
    return parent.has_value();
  }
  bool redo() {
    const std::optional<std::int64_t> above = state_above();
    if (above) change([&] { current_ = *above; });
    return above.has_value();
  }
  bool can_undo() { return parent_of(current_).has_value(); }
  bool can_redo() { return state_above().has_value(); }
  void go_to(const std::string& where) {
    const std::vector<std::pair<std::string, std::int64_t>> ends = branches();
    for (const auto& [name, tip] : ends)
      if (name == where) return change([&, to = tip] { branch_ = where, current_ = to; });
    Query version = query("SELECT edit FROM versions WHERE name = ?", where);
    std::optional<std::int64_t> to;
    if (version.next()) to = version.number(0);
    const bool is_number =
        !where.empty() && where.size() < 19 &&
        std::all_of(where.begin(), where.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!to && is_number && has_edit(std::stoll(where))) to = std::stoll(where);
    if (!to) {
      std::vector<std::string> known;
      known.reserve(ends.size());
      for (const auto& [name, tip] : ends) known.push_back(name);
      Query names = query("SELECT name FROM versions ORDER BY name");
      while (names.next()) known.push_back(names.text(0));
      throw std::runtime_error("the history has no state, version or branch '" + where + "'" +
                               suggestion(where, known));
    }
    change([&] { current_ = *to; });
  }
  void begin_branch(const std::string& name) {
    need_new_name(name);
    change([&] {
      query("INSERT INTO branches VALUES (?, ?)", name, current_).next();
      branch_ = name;
    });
  }
  void name_version(const std::string& name) {
    need_new_name(name);
    change([&] { query("INSERT INTO versions VALUES (?, ?)", name, current_).next(); });
  }

  std::int64_t current() const { return current_; }
  const std::string& branch() const { return branch_; }
  std::string text_of(std::int64_t edit) {
    std::vector<std::tuple<std::size_t, std::size_t, std::string>> changes;
    for (std::optional<std::int64_t> at = edit; at;) {
      Query row = query("SELECT parent, depth, head, tail, middle FROM edits WHERE id = ?", *at);
      if (!row.next()) throw std::runtime_error("the history has no state " + std::to_string(edit));
      changes.emplace_back(static_cast<std::size_t>(row.number(2)), static_cast<std::size_t>(row.number(3)),
                           row.text(4));
      if (row.number(1) == 0) break;
      if (row.number(0) >= *at) refuse_damaged(*at);
      at = row.number(0);
    }
    std::string text;
    for (auto change = changes.rbegin(); change != changes.rend(); ++change) {
      const auto& [head, tail, middle] = *change;
      if (head > text.size() || tail > text.size() - head) refuse_damaged(edit);
      text.replace(head, text.size() - tail - head, middle);
    }
    if (sha256_of(text) != sum_of(edit)) refuse_damaged(edit);
    return text;
  }
  std::int64_t edit_count() {
    Query count = query("SELECT max(id) FROM edits");
    count.next();
    return count.number(0);
  }
  std::vector<PlanEdit> newest(std::int64_t most) {
    std::vector<PlanEdit> edits;
    Query row = query("SELECT id, parent, what, made_at FROM edits ORDER BY id DESC LIMIT ?", most);
    while (row.next()) {
      edits.push_back({row.number(0),
                       row.is_null(1) ? std::nullopt : std::optional(row.number(1)),
                       row.text(2),
                       row.text(3),
                       {}});
    }
    if (edits.empty()) return edits;
    // Versions are not indexed by state, so all of them are read once.
    Query names = query("SELECT edit, name FROM versions WHERE edit >= ? ORDER BY name", edits.back().id);
    while (names.next()) {
      const auto named = std::lower_bound(edits.begin(), edits.end(), names.number(0),
                                          [](const PlanEdit& edit, std::int64_t id) { return edit.id > id; });
      if (named != edits.end() && named->id == names.number(0)) named->names.push_back(names.text(1));
    }
    return edits;
  }
  std::vector<std::pair<std::string, std::int64_t>> branches() {
    std::vector<std::pair<std::string, std::int64_t>> found;
    Query row = query("SELECT name, tip FROM branches ORDER BY name");
    while (row.next()) found.emplace_back(row.text(0), row.number(1));
    return found;
  }

 private:
  void open_file(int how, const std::string& name) {
    if (sqlite3_open_v2(name.c_str(), &database_, how | SQLITE_OPEN_NOMUTEX, nullptr) != SQLITE_OK) {
      const std::string why = database_ == nullptr ? "out of memory" : sqlite3_errmsg(database_);
      throw std::runtime_error(path_.string() + ": cannot be opened as the plan's history: " + why);
    }
    sqlite3_busy_timeout(database_, busy_ms);
  }
  void open_to_write() {
    need_writable();
    make_as_readable_as_the_plan();
    open_file(SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, path_.string());
    // Does nothing if another process has an older history open, whose log then stays. No state is lost.
    sqlite3_exec(database_, "PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
    run("PRAGMA synchronous = EXTRA");
    open();
  }
  void open_to_read() {
    need_history();
    open_file(SQLITE_OPEN_READONLY, path_.string());
    // An older history has a log; reading it requires a file beside the history. If that file cannot be
    // written and the log is empty, no process has the history open, and it is read without locks.
    const int code = sqlite3_exec(database_, "PRAGMA user_version", nullptr, nullptr, nullptr);
    if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY) {
      for (const char* ending : {"-wal", "-journal"}) need_nothing_beside(ending);
      sqlite3_close(std::exchange(database_, nullptr));
      open_file(SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, "file:" + uri_of(path_) + "?immutable=1");
    }
    need_known_layout();
    read_state();
  }
  void need_nothing_beside(const std::string& ending) const {
    std::error_code absent;
    const auto bytes = fs::file_size(path_.string() + ending, absent);
    if (!absent && bytes > 0) refuse_read_only(path_);
  }
  void need_history() const {
    if (!fs::exists(path_))
      throw std::runtime_error(plan_.string() + ": has no history yet, and none can be begun in " +
                               plan_.parent_path().string() +
                               ", which cannot be written: copy the plan to a folder of yours");
  }
  void need_writable() const {
    if (can_write(plan_)) return;
    const bool is_folder = ::access(plan_.parent_path().c_str(), W_OK) != 0;
    throw std::runtime_error((is_folder ? plan_.parent_path() : path_).string() +
                             ": cannot be written, so the plan's states cannot be stored there: copy the "
                             "plan and its .history to a folder in which you may write");
  }
  /// Reports a damaged history: the current edit is missing, an edit is not newer than its parent, or its
  /// text cannot be put together or does not have the stored checksum.
  [[noreturn]] void refuse_damaged(std::int64_t edit) const {
    throw std::runtime_error(path_.string() + ": the history is damaged at state " + std::to_string(edit) +
                             ": move it away, and a new one is begun");
  }
  /// Gives a new history the permissions of the plan's file, because it contains the plan's text. The owner
  /// may always write it.
  void make_as_readable_as_the_plan() const {
    struct stat of_plan {};
    if (::stat(plan_.c_str(), &of_plan) != 0) return;
    const int file = ::open(path_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC,
                            (of_plan.st_mode & 0666) | S_IRUSR | S_IWUSR);
    if (file >= 0) ::close(file);
  }

  template <typename... Values>
  Query query(const char* text, const Values&... values) {
    Query made(database_, path_, text);
    (made.with(values), ...);
    return made;
  }
  void run(const char* text) {
    if (sqlite3_exec(database_, text, nullptr, nullptr, nullptr) != SQLITE_OK) fail(database_, path_);
  }

  /// Runs `act` in an exclusive transaction. If it throws, none of its changes remain.
  template <typename Act>
  void locked(const Act& act) {
    run("BEGIN IMMEDIATE");
    try {
      act();
      run("COMMIT");
    } catch (...) {
      sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
      throw;
    }
  }

  void open() {
    locked([&] {
      const std::string text = read_text(plan_);
      if (need_known_layout() == 0) begin(text);
      settle(text);
    });
  }
  /// Makes the plan's file, whose text is `text`, and the current state agree. If another program has written
  /// the file, its text becomes an edit; otherwise the file is written.
  void settle(const std::string& text) {
    read_state();
    const std::string sum = sha256_of(text), current_sum = sum_of(current_);
    if (sum != current_sum && sum != written_) {
      add(text, "changed outside", current_);
      query("UPDATE branches SET tip = ? WHERE name = ?", current_, branch_).next();
      query("UPDATE state SET current = ?", current_).next();
    } else if (sum != current_sum) {
      voxel::write_whole(plan_, text_of(current_));
    }
    if (const std::string now = sum_of(current_); now != written_) {
      query("UPDATE state SET written = ?", now).next();
      written_ = now;
    }
  }
  /// The version of the database's layout; 0 for a new file. Throws if it is a later version than this
  /// program has.
  int need_known_layout() {
    Query row = query("PRAGMA user_version");
    row.next();
    if (row.number(0) > layout)
      throw std::runtime_error(path_.string() + ": a newer program wrote this history: install that");
    return static_cast<int>(row.number(0));
  }
  void begin(const std::string& text) {
    run(tables);
    run("PRAGMA user_version = 1");
    add(text, "begun", std::nullopt);
    query("INSERT INTO branches VALUES ('main', ?)", current_).next();
    query("INSERT INTO state VALUES (?, 'main', ?)", current_, sha256_of(text)).next();
  }
  void read_state() {
    Query row = query("SELECT current, branch, written FROM state");
    if (!row.next()) throw std::runtime_error(path_.string() + ": the history has no state: move it away");
    current_ = row.number(0);
    branch_ = row.text(1);
    written_ = row.text(2);
    if (!has_edit(current_)) refuse_damaged(current_);
  }

  /// Runs a change of the current state by the steps 1 to 3 above. Throws OtherWriter if another program has
  /// changed the history or the plan before.
  template <typename Change>
  void change(const Change& make) {
    const std::int64_t current = current_;
    const std::string branch = branch_;
    try {
      locked([&] {
        need_no_other_writer();
        make();
        query("UPDATE state SET current = ?, branch = ?", current_, branch_).next();
      });
    } catch (...) {
      current_ = current;
      branch_ = branch;
      throw;
    }
    // Another program may have made a further change in the meantime. This object keeps its own position, so
    // that its next change is refused.
    const std::int64_t made = current_;
    const std::string made_on = branch_;
    locked([&] { settle(read_text(plan_)); });
    current_ = made;
    branch_ = made_on;
  }

  /// Adds an edit and makes it the current state.
  void add(const std::string& text, const std::string& what, std::optional<std::int64_t> parent) {
    std::int64_t depth = 0;
    std::size_t head = 0, tail = 0;
    if (parent) {
      Query row = query("SELECT depth FROM edits WHERE id = ?", *parent);
      row.next();
      depth = (row.number(0) + 1) % whole_every;
    }
    if (depth > 0) {
      const std::string old = text_of(*parent);
      const std::size_t least = std::min(old.size(), text.size());
      while (head < least && old[head] == text[head]) ++head;
      while (tail < least - head && old[old.size() - 1 - tail] == text[text.size() - 1 - tail]) ++tail;
    }
    query("INSERT INTO edits (parent, what, sum, depth, head, tail, middle) VALUES (?, ?, ?, ?, ?, ?, ?)",
          parent, what, sha256_of(text), depth, static_cast<std::int64_t>(head),
          static_cast<std::int64_t>(tail), Bytes{text.substr(head, text.size() - tail - head)})
        .next();
    current_ = sqlite3_last_insert_rowid(database_);
  }
  std::optional<std::int64_t> parent_of(std::int64_t edit) {
    Query row = query("SELECT parent FROM edits WHERE id = ?", edit);
    if (!row.next() || row.is_null(0)) return std::nullopt;
    if (row.number(0) >= edit) refuse_damaged(edit);
    return row.number(0);
  }
  /// The state after the current one on the current branch. None if the current state is the branch's last
  /// one or is not on the branch.
  std::optional<std::int64_t> state_above() {
    const std::optional<std::int64_t> tip = tip_of(branch_);
    if (!tip || *tip <= current_) return std::nullopt;
    if (way_.empty() || way_.front() != *tip) way_ = {*tip};
    if (way_.back() > current_) extend_way();
    const auto here = std::lower_bound(way_.begin(), way_.end(), current_, std::greater<>());
    if (here == way_.end() || *here != current_) return std::nullopt;
    return *std::prev(here);
  }
  /// Extends `way_` from the branch's end towards the first state, down to the current state or an earlier
  /// one.
  void extend_way() {
    Query row = query(
        "WITH RECURSIVE way (id, parent) AS (SELECT id, parent FROM edits WHERE id = ? UNION ALL "
        "SELECT edits.id, edits.parent FROM way JOIN edits ON edits.id = way.parent "
        "WHERE way.id > ? AND way.parent < way.id) SELECT id, parent FROM way",
        way_.back(), current_);
    way_.pop_back();
    while (row.next()) {
      way_.push_back(row.number(0));
      if (!row.is_null(1) && row.number(1) >= row.number(0)) refuse_damaged(row.number(0));
    }
  }
  std::optional<std::int64_t> tip_of(const std::string& branch) {
    Query row = query("SELECT tip FROM branches WHERE name = ?", branch);
    return row.next() ? std::optional(row.number(0)) : std::nullopt;
  }
  std::string sum_of(std::int64_t edit) {
    Query row = query("SELECT sum FROM edits WHERE id = ?", edit);
    return row.next() ? row.text(0) : "";
  }
  bool has_edit(std::int64_t edit) { return query("SELECT 1 FROM edits WHERE id = ?", edit).next(); }
  void need_new_name(const std::string& name) {
    if (name.size() > longest_name)
      throw std::runtime_error("a name has " + std::to_string(longest_name) + " bytes at most, not " +
                               std::to_string(name.size()));
    if (has_control(name)) throw std::runtime_error("a name has letters and no control characters");
    const bool is_taken = query("SELECT 1 FROM branches WHERE name = ?", name).next() ||
                          query("SELECT 1 FROM versions WHERE name = ?", name).next();
    if (is_taken) throw std::runtime_error("the name '" + name + "' is taken: choose another");
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])))
      throw std::runtime_error("the name '" + name +
                               "' must not begin with a digit, because numbers name states");
  }

  fs::path plan_, path_;
  sqlite3* database_ = nullptr;
  std::int64_t current_ = 0;
  std::string branch_, written_;
  std::vector<std::int64_t> way_;  ///< states from a branch's end downwards, newest first
};

PlanHistory::PlanHistory(const fs::path& plan, Access access)
    : database_(std::make_unique<Database>(plan, access)) {}
PlanHistory::~PlanHistory() = default;

bool PlanHistory::can_write(const fs::path& plan) {
  const fs::path file = voxel::behind_links(fs::absolute(plan)), history = path_of(file);
  return ::access(file.parent_path().c_str(), W_OK) == 0 &&
         (!fs::exists(history) || ::access(history.c_str(), W_OK) == 0);
}

fs::path PlanHistory::path_of(const fs::path& plan) {
  return voxel::behind_links(plan).string() + ".history";
}

std::int64_t PlanHistory::record(const std::string& text, const std::string& what) {
  return database_->record(text, what);
}
void PlanHistory::need_no_other_writer() {
  database_->need_no_other_writer();
}
bool PlanHistory::undo() {
  return database_->undo();
}
bool PlanHistory::redo() {
  return database_->redo();
}
bool PlanHistory::can_undo() const {
  return database_->can_undo();
}
bool PlanHistory::can_redo() const {
  return database_->can_redo();
}
void PlanHistory::go_to(const std::string& where) {
  database_->go_to(where);
}
void PlanHistory::begin_branch(const std::string& name) {
  database_->begin_branch(name);
}
void PlanHistory::name_version(const std::string& name) {
  database_->name_version(name);
}
std::int64_t PlanHistory::current() const {
  return database_->current();
}
std::string PlanHistory::branch() const {
  return database_->branch();
}
std::string PlanHistory::text() const {
  return database_->text_of(database_->current());
}
std::string PlanHistory::text_of(std::int64_t edit) const {
  return database_->text_of(edit);
}
std::int64_t PlanHistory::edit_count() const {
  return database_->edit_count();
}
std::vector<PlanEdit> PlanHistory::newest(std::int64_t most) const {
  return database_->newest(most);
}
std::vector<std::pair<std::string, std::int64_t>> PlanHistory::branches() const {
  return database_->branches();
}

}  // namespace octotomy::planner
