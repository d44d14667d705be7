// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/field_json.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"

namespace octotomy::planner {
namespace {

std::string number_text(double value) {
  std::string text = SortedJson(value).dump();
  return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

std::string for_example(const Field& field) {
  return field.sample.empty() ? "" : ", for example " + field.sample;
}

/// A field's range in words, such as "above zero" or "from 0 to 1".
std::string range_text(const Field& field) {
  const auto bound = [](double value) { return value == 0.0 ? std::string("zero") : number_text(value); };
  std::string low, high;
  if (field.above) low = "above " + bound(*field.above);
  if (field.least) low = (field.most || field.below ? "from " : "at least ") + number_text(*field.least);
  if (field.most) high = (field.least ? "to " : "at most ") + number_text(*field.most);
  if (field.below) high = (field.least ? "to less than " : "less than ") + number_text(*field.below);
  return low + (low.empty() || high.empty() ? "" : field.above ? " and " : " ") + high;
}

bool in_range(const Field& field, double value) {
  return !(field.above && value <= *field.above) && !(field.least && value < *field.least) &&
         !(field.most && value > *field.most) && !(field.below && value >= *field.below);
}

/// Reads one value from JSON. The overloads of read() are for the types of Slot.
class Reader {
 public:
  Reader(const Field& field, const SortedJson& json, const FieldLocation& place)
      : field_(field), json_(json), place_(place) {}

  void read(bool* value) const {
    if (!json_.is_boolean()) place_.refuse("must be true or false");
    *value = json_.get<bool>();
  }
  void read(double* value) const { *value = number(json_, place_); }
  void read(int* value) const {
    number(json_, place_);
    *value = whole(json_, place_);
  }
  void read(std::string* value) const {
    *value = text(json_, place_);
    if (!field_.words.empty() &&
        std::find(field_.words.begin(), field_.words.end(), *value) == field_.words.end())
      place_.refuse("'" + *value + "' is not allowed here" + suggestion(*value, field_.words));
  }
  void read(std::filesystem::path* value) const { *value = text(json_, place_); }
  void read(ObjectName* value) const {
    value->name = text(json_, place_);
    place_.need_object(value->name);
  }
  void read(ScanName* value) const {
    value->name = text(json_, place_);
    place_.need_scan(value->name);
  }
  void read(Site* value) const {
    if (!json_.is_string()) return read(&value->point_mm);
    value->object = text(json_, place_);
    place_.need_object(value->object);
  }
  void read(Mark* value) const { *value = mark(json_, place_); }
  void read(std::vector<Mark>* value) const {
    each("points [x, y, z] or names of landmarks",
         [&](const SortedJson& entry, const FieldLocation& at) { value->push_back(mark(entry, at)); });
  }
  void read(glm::dmat4* value) const {
    const auto refuse = [&] { place_.refuse("must be four rows of four numbers, as printed by register"); };
    if (!json_.is_array() || json_.size() != 4) refuse();
    for (int row = 0; row < 4; ++row) {
      const SortedJson& numbers = json_[static_cast<std::size_t>(row)];
      if (!numbers.is_array() || numbers.size() != 4) refuse();
      for (int column = 0; column < 4; ++column)
        (*value)[column][row] = number_of(numbers[static_cast<std::size_t>(column)], place_.where);
    }
  }
  void read(SampleWindow* value) const {
    const std::string said = text(json_, place_);
    try {
      *value = parse_sample_window(said);
    } catch (const std::runtime_error& error) {
      place_.refuse(error.what());
    }
  }
  void read(glm::dvec3* value) const {
    *value = point(json_, place_);
    if (field_.is_direction && *value == glm::dvec3(0.0))
      place_.refuse("has no direction: write for example [1, 0, 0]");
  }
  template <typename Value>
  void read(std::optional<Value>* value) const {
    read(&value->emplace());
  }
  void read(std::vector<double>* value) const {
    value->clear();  // of the default
    each("numbers", [&](const SortedJson& entry, const FieldLocation& at) {
      value->push_back(number_of(entry, at.where));
    });
  }
  void read(std::vector<int>* value) const {
    each("whole numbers",
         [&](const SortedJson& entry, const FieldLocation& at) { value->push_back(whole(entry, at)); });
  }
  void read(std::vector<std::string>* value) const {
    each("texts", [&](const SortedJson& entry, const FieldLocation& at) {
      Reader(field_, entry, at).read(&value->emplace_back());
    });
  }
  void read(std::vector<glm::dvec3>* value) const {
    each("points [x, y, z]",
         [&](const SortedJson& entry, const FieldLocation& at) { value->push_back(point(entry, at)); });
  }
  void read(std::vector<ObjectName>* value) const {
    each("names of earlier steps", [&](const SortedJson& entry, const FieldLocation& at) {
      if (!entry.is_string()) place_.refuse("must contain names of earlier steps, not " + type_of(entry));
      value->push_back({entry.get<std::string>()});
      FieldLocation{place_.where, at.scope}.need_object(value->back().name);
    });
  }
  void read(Polygons* value) const {
    each("polygons", [&](const SortedJson& polygon, const FieldLocation& at) {
      if (!polygon.is_array()) at.refuse("must be a list of points [u, v]");
      auto& points = value->emplace_back();
      for (const SortedJson& entry : polygon)
        points.push_back(point_of(entry, at.where + "[" + std::to_string(points.size()) + "]"));
    });
  }
  void read(NamePairs* value) const {
    const std::string wanted = "must be a list of pairs of names" + for_example(field_);
    if (!json_.is_array()) place_.refuse(wanted);
    for (const SortedJson& pair : json_) {
      if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string())
        place_.refuse(wanted);
      value->emplace_back(pair[0].get<std::string>(), pair[1].get<std::string>());
    }
  }
  void read(const Records& records) const {
    if (records.form == Records::Form::Optional)
      return read_fields(field_.fields, json_, records.add(""), place_);
    if (records.form == Records::Form::List) {
      each("records", [&](const SortedJson& entry, const FieldLocation& at) {
        read_fields(field_.fields, entry, records.add(""), at);
      });
      return;
    }
    if (!json_.is_object()) place_.refuse("must be an object in braces, not " + type_of(json_));
    for (const auto& [name, entry] : json_.items())
      read_fields(field_.fields, entry, records.add(name), place_.at(name));
  }

 private:
  static std::string text(const SortedJson& json, const FieldLocation& place) {
    if (!json.is_string()) place.refuse("must be a text in quotes, not " + type_of(json));
    if (json.get_ref<const std::string&>().empty()) place.refuse("is empty: state a value");
    return json.get<std::string>();
  }
  double number(const SortedJson& json, const FieldLocation& place) const {
    const double value = number_of(json, place.where);
    if (!in_range(field_, value)) place.refuse("must be " + range_text(field_) + for_example(field_));
    return value;
  }
  static int whole(const SortedJson& json, const FieldLocation& place) {
    const double value = number_of(json, place.where);
    if (value != std::trunc(value) || std::abs(value) > std::numeric_limits<int>::max())
      place.refuse("must be a whole number");
    return static_cast<int>(value);
  }
  static glm::dvec3 point(const SortedJson& json, const FieldLocation& place) {
    if (!json.is_array() || json.size() != 3) place.refuse("must be three numbers [x, y, z]");
    return {number_of(json[0], place.where), number_of(json[1], place.where),
            number_of(json[2], place.where)};
  }
  static Mark mark(const SortedJson& json, const FieldLocation& place) {
    if (json.is_array()) return {point(json, place), "", ""};
    if (!json.is_string()) place.refuse("must be three numbers [x, y, z] or the name of a landmark");
    const std::string said = text(json, place);
    if (place.scope == nullptr)
      place.refuse("'" + said + "' names a landmark, which only plans have: write X,Y,Z");
    Mark mark;
    const std::size_t at = said.find('@');
    mark.landmark = said.substr(0, at);
    mark.p_mm = place.scope->landmark_mm(place.where, mark.landmark);
    if (at == std::string::npos) return mark;
    mark.object = said.substr(at + 1);
    place.need_object(mark.object);
    return mark;
  }
  template <typename Act>
  void each(const std::string& of, const Act& act) const {
    if (!json_.is_array()) place_.refuse("must be a list of " + of + for_example(field_));
    if (field_.least && static_cast<double>(json_.size()) < *field_.least)
      place_.refuse("must be a list of at least " + number_text(*field_.least) + " " + of +
                    for_example(field_));
    if (field_.most && static_cast<double>(json_.size()) > *field_.most)
      place_.refuse("must be a list of at most " + number_text(*field_.most) + " " + of);
    std::size_t index = 0;
    for (const SortedJson& entry : json_)
      act(entry, {place_.where + "[" + std::to_string(index++) + "]", place_.scope});
  }

  const Field& field_;
  const SortedJson& json_;
  const FieldLocation& place_;
};

Json json_of(const glm::dvec3& value) {
  return {value.x, value.y, value.z};
}

/// Prints one value as JSON; null if there is none.
struct Printer {
  const Field& field;

  Json operator()(const bool* value) const { return *value; }
  Json operator()(const int* value) const { return *value; }
  Json operator()(const double* value) const { return *value; }
  Json operator()(const std::string* value) const { return value->empty() ? Json() : Json(*value); }
  Json operator()(const std::filesystem::path* value) const {
    return value->empty() ? Json() : Json(value->generic_string());
  }
  Json operator()(const glm::dvec3* value) const { return json_of(*value); }
  Json operator()(const ObjectName* value) const { return (*this)(&value->name); }
  Json operator()(const ScanName* value) const { return (*this)(&value->name); }
  Json operator()(const Site* value) const {
    return value->object.empty() ? json_of(value->point_mm) : Json(value->object);
  }
  Json operator()(const Mark* value) const {
    if (value->landmark.empty()) return json_of(value->p_mm);
    return value->landmark + (value->object.empty() ? "" : "@" + value->object);
  }
  Json operator()(const glm::dmat4* value) const {
    Json rows = Json::array();
    for (int row = 0; row < 4; ++row)
      rows.push_back({(*value)[0][row], (*value)[1][row], (*value)[2][row], (*value)[3][row]});
    return rows;
  }
  Json operator()(const SampleWindow* value) const { return to_string(*value); }
  template <typename Value>
  Json operator()(const std::optional<Value>* value) const {
    return *value ? (*this)(&**value) : Json();
  }
  template <typename Value>
  Json operator()(const std::vector<Value>* values) const {
    if (values->empty()) return {};
    Json list = Json::array();
    for (const Value& value : *values) list.push_back((*this)(&value));
    return list;
  }
  Json operator()(const std::vector<glm::dvec2>* polygon) const {
    Json list = Json::array();
    for (const glm::dvec2& point : *polygon) list.push_back({point.x, point.y});
    return list;
  }
  Json operator()(const std::pair<std::string, std::string>* pair) const {
    return Json::array({pair->first, pair->second});
  }
  Json operator()(const Records& records) const {
    if (records.count == 0) return {};
    if (records.form == Records::Form::Optional) return print_fields(field.fields, records.at(0));
    Json all = records.form == Records::Form::List ? Json::array() : Json::object();
    for (std::size_t i = 0; i < records.count; ++i) {
      Json one = print_fields(field.fields, records.at(i));
      if (records.form == Records::Form::List)
        all.push_back(std::move(one));
      else
        all[records.name_of(i)] = std::move(one);
    }
    return all;
  }
};

const SortedJson vector_schema = {
    {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};

/// The JSON schema of a field's type, without the field's description.
struct Schema {
  const Field& field;

  Json operator()(const bool*) const { return {{"type", "boolean"}}; }
  Json operator()(const int*) const { return ranged("integer"); }
  Json operator()(const double*) const { return ranged("number"); }
  Json operator()(const std::string*) const {
    Json schema{{"type", "string"}, {"minLength", 1}};
    if (!field.words.empty()) schema["enum"] = field.words;
    return schema;
  }
  Json operator()(const std::filesystem::path*) const { return {{"type", "string"}, {"minLength", 1}}; }
  Json operator()(const glm::dvec3*) const { return vector_schema; }
  Json operator()(const ObjectName*) const {
    return {{"type", "string"}, {"minLength", 1}, {"x-names", "object"}};
  }
  Json operator()(const ScanName*) const { return {{"type", "string"}, {"minLength", 1}}; }
  Json operator()(const SampleWindow*) const { return {{"type", "string"}, {"minLength", 1}}; }
  Json operator()(const Site*) const {
    return {{"oneOf", {Json(vector_schema), {{"type", "string"}, {"minLength", 1}}}}};
  }
  Json operator()(const Mark*) const { return (*this)(static_cast<const Site*>(nullptr)); }
  Json operator()(const glm::dmat4*) const {
    const Json row{{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 4}, {"maxItems", 4}};
    return {{"type", "array"}, {"items", row}, {"minItems", 4}, {"maxItems", 4}};
  }
  template <typename Value>
  Json operator()(const std::optional<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
  template <typename Value>
  Json operator()(const std::vector<Value>*) const {
    Field entry = field;  // here `least` and `most` limit the number of entries, not the entries
    entry.least = entry.most = std::nullopt;
    Json schema{{"type", "array"}, {"items", Schema{entry}(static_cast<const Value*>(nullptr))}};
    if (field.least) schema["minItems"] = static_cast<int>(*field.least);
    if (field.most) schema["maxItems"] = static_cast<int>(*field.most);
    return schema;
  }
  Json operator()(const std::vector<glm::dvec2>*) const {
    const Json point{{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}};
    return {{"type", "array"}, {"items", point}};
  }
  Json operator()(const std::pair<std::string, std::string>*) const {
    return {{"type", "array"}, {"items", {{"type", "string"}}}, {"minItems", 2}, {"maxItems", 2}};
  }
  Json operator()(const Records& records) const {
    Json one = fields_schema(field.fields, records.add("name"));
    if (records.form == Records::Form::List) {
      Json list{{"type", "array"}, {"items", one}};
      if (field.least) list["minItems"] = static_cast<int>(*field.least);
      return list;
    }
    if (records.form == Records::Form::ByName) return {{"type", "object"}, {"additionalProperties", one}};
    return one;
  }

 private:
  Json ranged(const char* type) const {
    Json schema{{"type", type}};
    if (field.above) schema["exclusiveMinimum"] = *field.above;
    if (field.least) schema["minimum"] = *field.least;
    if (field.most) schema["maximum"] = *field.most;
    if (field.below) schema["exclusiveMaximum"] = *field.below;
    return schema;
  }
};

double need_number(const std::string& word, const Field& field) {
  const std::optional<double> value = number_in(word);
  if (!value) throw std::runtime_error("'" + word + "' is not a number" + for_example(field));
  return *value;
}

SortedJson point_in(const std::string& word) {
  const std::vector<double> point = comma_numbers(word);
  if (point.size() != 3)
    throw std::runtime_error("'" + word + "' is not a point: write X,Y,Z, for example -10,25.5,40");
  return point;
}

/// A word that is JSON itself: a record or a matrix.
SortedJson json_in(const std::string& word, const Field& field) {
  SortedJson json = SortedJson::parse(word, nullptr, false);
  if (json.is_discarded()) throw std::runtime_error("'" + word + "' is not JSON" + for_example(field));
  return json;
}

/// One word of the command line as JSON, according to the field's type.
struct JsonOfWord {
  const Field& field;
  const std::string& word;

  SortedJson operator()(const bool*) const { return true; }
  SortedJson operator()(const int*) const { return need_number(word, field); }
  SortedJson operator()(const double*) const { return need_number(word, field); }
  SortedJson operator()(const glm::dvec3*) const { return point_in(word); }
  SortedJson operator()(const Site*) const {
    return word.find(',') == std::string::npos ? SortedJson(word) : point_in(word);
  }
  SortedJson operator()(const Mark*) const { return (*this)(static_cast<const Site*>(nullptr)); }
  template <typename Value>
  SortedJson operator()(const std::optional<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
  template <typename Value>
  SortedJson operator()(const std::vector<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
  SortedJson operator()(const glm::dmat4*) const { return json_in(word, field); }
  SortedJson operator()(const Records&) const { return json_in(word, field); }
  SortedJson operator()(const void*) const { return word; }
};

/// The form of one word of a field, for help.
struct Form {
  std::string operator()(const bool*) const { return ""; }
  std::string operator()(const int*) const { return "N"; }
  std::string operator()(const double*) const { return "NUMBER"; }
  std::string operator()(const glm::dvec3*) const { return "X,Y,Z"; }
  std::string operator()(const Mark*) const { return "X,Y,Z"; }
  std::string operator()(const ObjectName*) const { return "FILE"; }
  std::string operator()(const ScanName*) const { return "SCAN"; }
  std::string operator()(const SampleWindow*) const { return "LOW:HIGH"; }
  std::string operator()(const std::filesystem::path*) const { return "FILE"; }
  template <typename Value>
  std::string operator()(const std::optional<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
  template <typename Value>
  std::string operator()(const std::vector<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
  std::string operator()(const glm::dmat4*) const { return "JSON"; }
  std::string operator()(const Records&) const { return "JSON"; }
  std::string operator()(const void*) const { return "TEXT"; }
};

template <typename Value>
constexpr bool is_list = false;
template <typename Value>
constexpr bool is_list<std::vector<Value>*> = true;

}  // namespace

void read_fields(const std::vector<Field>& fields, const SortedJson& object, void* owner,
                 const FieldLocation& place, const std::vector<std::string>& also) {
  if (!object.is_object()) place.refuse("must be an object in braces, not " + type_of(object));
  std::vector<std::string> known = also;
  for (const Field& field : fields) known.push_back(field.name);
  std::sort(known.begin(), known.end());
  for (const auto& [key, unused] : object.items())
    if (!std::binary_search(known.begin(), known.end(), key))
      place.refuse("unknown key '" + key + "'" + suggestion(key, known));
  for (const Field& field : fields) {
    const auto found = object.find(field.name);
    if (found == object.end() || found->is_null()) {
      if (field.is_required) place.refuse("'" + field.name + "' is missing: add it");
      continue;
    }
    const FieldLocation at = place.at(field.name);
    const Reader reader(field, *found, at);
    std::visit([&](const auto& slot) { reader.read(slot); }, field.slot(owner));
  }
}

void need_fields_read(const std::vector<Field>& fields, const SortedJson& object, const void* owner,
                      const FieldLocation& place) {
  for (const Field& field : fields) {
    const auto* conditional = field.slot.target<ConditionalSlot>();
    const auto given = object.find(field.name);
    if (conditional == nullptr || given == object.end() || given->is_null() || *given == false ||
        (given->is_array() && given->empty()))
      continue;
    for (const ConditionalSlot::Condition& condition : conditional->conditions)
      if (!condition.is_read(owner)) place.at(field.name).refuse(condition.otherwise);
  }
}

/// Whether the operation reads a field for its present value. need_fields_read() refuses a stated field that
/// is not read.
static bool is_read(const Field& field, const void* owner) {
  const auto* conditional = field.slot.target<ConditionalSlot>();
  return conditional == nullptr ||
         std::all_of(conditional->conditions.begin(), conditional->conditions.end(),
                     [&](const ConditionalSlot::Condition& condition) { return condition.is_read(owner); });
}

Json print_fields(const std::vector<Field>& fields, void* owner) {
  Json object = Json::object();
  for (const Field& field : fields) {
    if (!is_read(field, owner)) continue;
    Json value = std::visit(Printer{field}, field.slot(owner));
    if (!value.is_null()) object[field.name] = std::move(value);
  }
  return object;
}

Json fields_schema(const std::vector<Field>& fields, void* fresh) {
  Json properties = Json::object(), required = Json::array();
  for (const Field& field : fields) {
    Json value;
    if (!field.is_required) value = std::visit(Printer{field}, field.slot(fresh));
    Json schema{{"description", field.says}};
    schema.update(std::visit(Schema{field}, field.slot(fresh)));
    if (!value.is_null()) schema["default"] = value;
    if (const std::string unit = field.unit(); !unit.empty()) schema["x-unit"] = unit;
    properties[field.name] = std::move(schema);
    if (field.is_required) required.push_back(field.name);
  }
  Json schema{{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!required.empty()) schema["required"] = required;
  return schema;
}

SortedJson json_of_words(const Field& field, void* fresh, const std::vector<std::string>& words) {
  const auto one = [&](const std::string& word) {
    return std::visit(JsonOfWord{field, word}, field.slot(fresh));
  };
  if (!takes_several(field, fresh)) return one(words.empty() ? "" : words.back());
  SortedJson list = SortedJson::array();
  for (const std::string& word : words) list.push_back(one(word));
  return list;
}

SortedJson json_of_values(const std::vector<Field>& fields, void* fresh,
                          const std::vector<std::string>& values) {
  SortedJson object = SortedJson::object();
  std::size_t at = 0;
  for (const Field& field : fields) {
    if (names_scan(field, fresh)) continue;
    if (at == values.size()) break;
    const bool is_point = std::holds_alternative<glm::dvec3*>(field.slot(fresh));
    const std::size_t left = values.size() - at;
    const std::size_t count = is_point ? 3 : takes_several(field, fresh) ? left : 1;
    if (count > left) throw std::runtime_error(field.name + ": must be three numbers");
    std::vector<std::string> words(values.begin() + static_cast<std::ptrdiff_t>(at),
                                   values.begin() + static_cast<std::ptrdiff_t>(at + count));
    if (is_point) words = {words[0] + "," + words[1] + "," + words[2]};
    object[field.name] = json_of_words(field, fresh, words);
    at += count;
  }
  if (at < values.size()) throw std::runtime_error("takes " + std::to_string(at) + " values at most");
  return object;
}

bool names_objects(const Field& field, void* fresh) {
  const Slot slot = field.slot(fresh);
  return std::holds_alternative<ObjectName*>(slot) ||
         std::holds_alternative<std::vector<ObjectName>*>(slot) ||
         std::holds_alternative<std::optional<ObjectName>*>(slot);
}

bool names_scan(const Field& field, void* fresh) {
  return std::holds_alternative<ScanName*>(field.slot(fresh));
}

bool takes_several(const Field& field, void* fresh) {
  return std::visit([](const auto& slot) { return is_list<std::decay_t<decltype(slot)>>; },
                    field.slot(fresh));
}

bool is_flag(const Field& field, void* fresh) {
  return std::holds_alternative<bool*>(field.slot(fresh));
}

std::string word_form(const Field& field, void* fresh) {
  const Slot slot = field.slot(fresh);
  const bool is_number =
      std::holds_alternative<double*>(slot) || std::holds_alternative<std::optional<double>*>(slot);
  if (field.unit() == "mm" && is_number) return "MM";
  return std::visit(Form{}, slot);
}

}  // namespace octotomy::planner
