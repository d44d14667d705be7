// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"
#include "planner/operation/table/object.h"
#include "planner/operation/table/scope.h"

// The table of operations. An operation is a typed value; its entry describes the value's fields and the work
// of each kernel. Plan steps, verbs, help and the schema derive from the entry. The header is long, because
// it contains both the entry and Describe, which builds the entry.
namespace octotomy::planner {

/// The result of a step: an object or a scan for later steps, numbers, a file in the result's folder, or
/// names and directions, which are bound in the document's scope when the step is checked.
enum class Makes { Object, Scan, Measurement, File, Names };

/// An entry of the table. Its functions take a pointer to the operation's value; Describe binds them to typed
/// functions.
struct Operation {
  std::string name;     ///< the value of `do` in a step, and the name of the verb
  std::string says;     ///< one plain sentence
  std::string example;  ///< a step as JSON
  Makes makes = Makes::Object;
  std::vector<Field> fields;
  std::type_index type = typeid(void);

  /// Makes a value with all defaults.
  std::function<std::shared_ptr<void>()> fresh;
  /// Checks conditions that involve several fields. Throws if a condition is not met.
  std::function<void(const void* value, const FieldLocation& place)> check;
  /// The object's definition in words for users, such as "skull & cut".
  std::function<std::string(const void* value, const Objects& objects)> definition;
  /// Adds computed results to the value, such as a plane of best fit. The later functions get the completed
  /// value. Empty if there is nothing to compute.
  std::function<std::shared_ptr<void>(const void* value, const SettleBench& bench)> settle;
  /// Makes a scan from another scan.
  std::function<MadeScan(const void* value, const ScanBench& bench)> scan;
  /// Computes the voxel kernel's answer. If empty, the mesh kernel's answer is voxelised.
  std::function<void(const void* value, const VoxelBench& bench, VoxelSide& made)> voxel;
  /// Computes the mesh kernel's answer. Empty if the mesh kernel has none.
  std::function<void(const void* value, const MeshBench& bench, MeshSide& made)> mesh;
  /// Sets the terms of the certificate's bound, and the samples that show the surface.
  std::function<void(const void* value, const BoundBench& bench, Object& made)> bound;
  /// Computes the numbers of a measurement, each with its half-width.
  std::function<nlohmann::ordered_json(const void* value, const AnswerBench& bench)> measure;
  /// Writes a file, or reports why it cannot be written.
  std::function<void(const void* value, const AnswerBench& bench, Exported& made)> write;
  /// Does the part of the work for a file that needs no certificate, in parallel with later steps. Stores its
  /// results in the bench's `kept`, from which `write` reads them. Empty if there is no such part.
  std::function<void(const void* value, const AnswerBench& bench)> prepare_file;
  /// The objects that the operation uses besides those that its fields name.
  std::function<std::vector<std::string>(const void* value)> uses;
  /// Examples of the operation as a verb on files; empty if it is not a verb. For an operation that makes a
  /// scan, the form of a step of `prepare`: "gaussian=SIGMA (mm)".
  std::string verb_example;
  /// Runs the verb if its answer is not an object of both kernels. In the value, objects are paths of files.
  std::function<FileAnswer(const void* value, const FileBench& bench)> on_files;
  /// The value, changed so that parts that contain these points, LPS, are also kept. Null if the operation
  /// does not select parts in both kernels.
  std::function<std::shared_ptr<void>(const void* value, const std::vector<glm::dvec3>& also_mm)> with_parts;
  /// The fields that only the verb has.
  std::vector<Field> verb_fields;
  /// Whether the verb has the options for reading scans.
  bool reads_scans = false;
  /// Whether the object only helps to make other objects, like a mask, and has no certificate.
  bool is_tool = false;
  /// Whether the object is that of the field `object` after a motion (Object::moved).
  bool is_motion = false;
  /// Whether the answer depends on the head's orientation, through views or words such as "forward".
  bool is_of_head = false;
};

/// Builds an entry from functions that take the operation's own type.
template <typename Value>
class Describe {
 public:
  Describe(std::string name, std::string says, Makes makes) {
    entry_.name = std::move(name);
    entry_.says = std::move(says);
    entry_.makes = makes;
    entry_.type = typeid(Value);
    entry_.fresh = [] { return std::make_shared<Value>(); };
  }
  Describe&& takes(Field field) && { return entry_.fields.push_back(std::move(field)), std::move(*this); }
  Describe&& takes(std::vector<Field> fields) && {
    for (Field& field : fields) entry_.fields.push_back(std::move(field));
    return std::move(*this);
  }
  Describe&& example(std::string json) && { return entry_.example = std::move(json), std::move(*this); }
  Describe&& on_files(std::string command) && {
    return entry_.verb_example = std::move(command), std::move(*this);
  }
  Describe&& on_files(std::string command, FileAnswer (*part)(const Value&, const FileBench&)) && {
    entry_.verb_example = std::move(command);
    return bind(entry_.on_files, part);
  }
  Describe&& verb_takes(Field field) && {
    return entry_.verb_fields.push_back(std::move(field)), std::move(*this);
  }
  /// Adds fields of a member of the value to the value's own fields. Precondition: none of them has
  /// read_if().
  template <typename Part>
  Describe&& verb_takes(Part Value::*part, std::vector<Field> fields) && {
    for (Field& field : fields) {
      field.slot = [slot = field.slot, part](void* owner) {
        return slot(&(static_cast<Value*>(owner)->*part));
      };
      entry_.verb_fields.push_back(std::move(field));
    }
    return std::move(*this);
  }
  Describe&& reads_scans() && { return entry_.reads_scans = true, std::move(*this); }
  Describe&& of_head() && { return entry_.is_of_head = true, std::move(*this); }
  Describe&& tool() && { return entry_.is_tool = true, std::move(*this); }
  Describe&& motion() && { return entry_.is_motion = true, std::move(*this); }
  Describe&& check(void (*part)(const Value&, const FieldLocation&)) && { return bind(entry_.check, part); }
  using Definition = std::string (*)(const Value&, const Objects&);
  using Voxels = void (*)(const Value&, const VoxelBench&, VoxelSide&);
  using Triangles = void (*)(const Value&, const MeshBench&, MeshSide&);
  using Bound = void (*)(const Value&, const BoundBench&, Object&);
  /// Binds the functions of an operation that makes an object. A function is null if its kernel has no
  /// answer.
  Describe&& object(Definition definition, Voxels voxels, Triangles triangles, Bound bound) && {
    bind(entry_.definition, definition);
    if (voxels != nullptr) bind(entry_.voxel, voxels);
    if (triangles != nullptr) bind(entry_.mesh, triangles);
    return bind(entry_.bound, bound);
  }
  Describe&& settle(Value (*part)(const Value&, const SettleBench&)) && {
    entry_.settle = [part](const void* value, const SettleBench& bench) -> std::shared_ptr<void> {
      return std::make_shared<Value>(part(*static_cast<const Value*>(value), bench));
    };
    return std::move(*this);
  }
  Describe&& with_parts(std::optional<Value> (*part)(const Value&, const std::vector<glm::dvec3>&)) && {
    entry_.with_parts = [part](const void* value,
                               const std::vector<glm::dvec3>& also_mm) -> std::shared_ptr<void> {
      std::optional<Value> made = part(*static_cast<const Value*>(value), also_mm);
      return made ? std::make_shared<Value>(std::move(*made)) : nullptr;
    };
    return std::move(*this);
  }
  Describe&& scan(MadeScan (*part)(const Value&, const ScanBench&)) && { return bind(entry_.scan, part); }
  Describe&& measure(nlohmann::ordered_json (*part)(const Value&, const AnswerBench&)) && {
    return bind(entry_.measure, part);
  }
  Describe&& write(void (*part)(const Value&, const AnswerBench&, Exported&)) && {
    return bind(entry_.write, part);
  }
  Describe&& prepares_file(void (*part)(const Value&, const AnswerBench&)) && {
    return bind(entry_.prepare_file, part);
  }
  Describe&& uses(std::vector<std::string> (*part)(const Value&)) && { return bind(entry_.uses, part); }
  operator Operation() && { return std::move(entry_); }

 private:
  template <typename Result, typename... Arguments>
  Describe&& bind(std::function<Result(const void*, Arguments...)>& to,
                  Result (*part)(const Value&, Arguments...)) {
    to = [part](const void* value, Arguments... arguments) -> Result {
      return part(*static_cast<const Value*>(value), arguments...);
    };
    return std::move(*this);
  }

  Operation entry_;
};

/// An operation of the table with its value.
class Action {
 public:
  explicit Action(const Operation& operation) : operation_(&operation), value_(operation.fresh()) {}

  const Operation& operation() const { return *operation_; }
  const void* value() const { return value_.get(); }
  void* value() { return value_.get(); }
  /// The value; null if its type is another one.
  template <typename Value>
  const Value* get_if() const {
    return operation_->type == typeid(Value) ? static_cast<const Value*>(value_.get()) : nullptr;
  }
  /// The value. Throws std::invalid_argument if its type is another one.
  template <typename Value>
  const Value& get() const {
    if (const Value* value = get_if<Value>()) return *value;
    throw std::invalid_argument("'" + operation_->name + "' is another operation");
  }

 private:
  const Operation* operation_;
  std::shared_ptr<void> value_;
};

/// All operations, by name.
const std::vector<Operation>& operations();
/// The operation with this name; null if there is none.
const Operation* find_operation(const std::string& name);
/// The objects that an action uses, without repetitions, in the order of its fields.
std::vector<std::string> objects_used(const Action& action);
/// The file that an action writes, as its field states it; empty if it writes none.
std::filesystem::path path_written(const Action& action);
/// The marks in an action's fields, in their order.
std::vector<Mark> marks_used(const Action& action);
/// The names of the scans that an action uses.
std::vector<std::string> scans_used(const Action& action);

}  // namespace octotomy::planner
