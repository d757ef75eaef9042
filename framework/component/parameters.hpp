/// Parameters are plain structs. One `describe` line a field says name, unit, range and help; check, describe, the
/// documentation and the loader all read that line.
///
///   struct PursuitParams {
///     Duration period = 100ms;
///     double speed = 0.5;
///     template <class Visitor> void describe(Visitor& v) {
///       v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two commands."});
///       v(speed, "speed", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed on a free course."});
///     }
///   };
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/component/error.hpp"
#include "framework/component/time.hpp"
#include "framework/component/value.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan {

/// What a person may write for a parameter, and how its Value is laid out.
enum class ParameterKind {
  boolean,   ///< bool
  integer,   ///< std::int64_t
  number,    ///< double, in `unit`
  duration,  ///< double, seconds
  text,      ///< std::string
  choice,    ///< std::string, one of `choices`
  path,      ///< std::string, an existing file (absolute once loaded)
  numbers,   ///< list of double, in `unit`
  texts,     ///< list of std::string
  pose,      ///< [x, y, yaw]: m, m, rad
  points,    ///< list of [x, y]: m
  pairs,     ///< list of [i, j]: integers
  records,   ///< map of name -> struct, described by `members`
};

/// The word used in messages and in the schema: "number", "list of [x, y]", …
std::string to_text(ParameterKind kind);

/// The attributes of one describe line.
struct ParameterSpec {
  const char* unit = "";
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};  ///< names of an enum class' enumerators 0, 1, … in order
  const char* help = "";
  bool required = false;  ///< the composition must give it
  bool live = false;      ///< may be changed while the component runs
};

/// One parameter of a component, as the manifest carries it.
struct ParameterInfo {
  std::string name;
  ParameterKind kind = ParameterKind::number;
  std::string unit = {};
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};
  std::string help = {};
  bool required = false;
  bool live = false;
  Value default_value = {};
  std::vector<ParameterInfo> members = {};  ///< of a records parameter
};

/// Nothing if `value` is allowed for `info`, else one sentence that says what is allowed, without the parameter's name:
/// "7 is out of range; allowed: 0 .. 5 m/s".
std::optional<std::string> refusal(const ParameterInfo& info, const Value& value);

/// The name among `known` nearest to `word`, if any is near enough to be what was meant.
std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& known);

/// A file named in a composition.
struct FilePath {
  std::string path;
  bool operator==(const FilePath&) const = default;
};

namespace detail {

template <class T>
struct is_records : std::false_type {};
template <class T>
struct is_records<std::map<std::string, T>> : std::true_type {};

/// A parameter that may be left out, and then is not there: std::optional of another type.
template <class T>
struct is_optional : std::false_type {};
template <class T>
struct is_optional<std::optional<T>> : std::true_type {};

using IndexPair = std::pair<std::int64_t, std::int64_t>;

Value to_value(bool v);
Value to_value(std::int64_t v);
Value to_value(double v);
Value to_value(Duration v);
Value to_value(const std::string& v);
Value to_value(const FilePath& v);
Value to_value(const std::vector<double>& v);
Value to_value(const std::vector<std::string>& v);
Value to_value(const geometry::Pose2& v);
Value to_value(const std::vector<geometry::Vector2>& v);
Value to_value(const std::vector<IndexPair>& v);

void from_value(const Value& value, bool& v);
void from_value(const Value& value, std::int64_t& v);
void from_value(const Value& value, double& v);
void from_value(const Value& value, Duration& v);
void from_value(const Value& value, std::string& v);
void from_value(const Value& value, FilePath& v);
void from_value(const Value& value, std::vector<double>& v);
void from_value(const Value& value, std::vector<std::string>& v);
void from_value(const Value& value, geometry::Pose2& v);
void from_value(const Value& value, std::vector<geometry::Vector2>& v);
void from_value(const Value& value, std::vector<IndexPair>& v);

template <class T>
constexpr ParameterKind kind_of() {
  if constexpr (is_optional<T>::value)
    return kind_of<typename T::value_type>();
  else if constexpr (std::is_same_v<T, bool>)
    return ParameterKind::boolean;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return ParameterKind::integer;
  else if constexpr (std::is_same_v<T, double>)
    return ParameterKind::number;
  else if constexpr (std::is_same_v<T, Duration>)
    return ParameterKind::duration;
  else if constexpr (std::is_same_v<T, std::string>)
    return ParameterKind::text;
  else if constexpr (std::is_same_v<T, FilePath>)
    return ParameterKind::path;
  else if constexpr (std::is_same_v<T, std::vector<double>>)
    return ParameterKind::numbers;
  else if constexpr (std::is_same_v<T, std::vector<std::string>>)
    return ParameterKind::texts;
  else if constexpr (std::is_same_v<T, geometry::Pose2>)
    return ParameterKind::pose;
  else if constexpr (std::is_same_v<T, std::vector<geometry::Vector2>>)
    return ParameterKind::points;
  else if constexpr (std::is_same_v<T, std::vector<IndexPair>>)
    return ParameterKind::pairs;
  else if constexpr (std::is_enum_v<T>)
    return ParameterKind::choice;
  else if constexpr (is_records<T>::value)
    return ParameterKind::records;
  else
    static_assert(sizeof(T) == 0, "this type is not supported as a parameter");
}

/// Collects the ParameterInfo of each describe line; the field's value is the default.
class SchemaVisitor {
 public:
  std::vector<ParameterInfo> parameters;

  template <class T>
  void operator()(T& field, const char* name, const ParameterSpec& spec) {
    ParameterInfo info{name,      kind_of<T>(),  spec.unit, spec.min, spec.max, spec.choices,
                       spec.help, spec.required, spec.live, Value(),  {}};
    if constexpr (is_optional<T>::value) {
      static_assert(kind_of<T>() != ParameterKind::records && kind_of<T>() != ParameterKind::choice);
      if (field) info.default_value = to_value(*field);
    } else if constexpr (kind_of<T>() == ParameterKind::records) {
      typename T::mapped_type record;
      SchemaVisitor members;
      record.describe(members);
      info.members = std::move(members.parameters);
      info.default_value = ValueMap();
    } else if constexpr (kind_of<T>() == ParameterKind::choice) {
      info.default_value = spec.choices.at(static_cast<std::size_t>(field));
    } else {
      info.default_value = to_value(field);
    }
    parameters.push_back(std::move(info));
  }
};

/// Sets the fields that `values` names. Values must have passed refusal().
class LoadVisitor {
 public:
  explicit LoadVisitor(const ValueMap& values) : values_(values) {}

  template <class T>
  void operator()(T& field, const char* name, const ParameterSpec& spec) {
    const auto found = values_.find(name);
    if (found == values_.end() || found->second.empty()) return;
    if constexpr (is_optional<T>::value) {
      from_value(found->second, field.emplace());
    } else if constexpr (kind_of<T>() == ParameterKind::records) {
      field.clear();
      for (const auto& [key, members] : std::get<ValueMap>(found->second)) {
        LoadVisitor load(std::get<ValueMap>(members));
        field[key].describe(load);
      }
    } else if constexpr (kind_of<T>() == ParameterKind::choice) {
      const auto& word = std::get<std::string>(found->second);
      for (std::size_t i = 0; i < spec.choices.size(); ++i)
        if (spec.choices[i] == word) field = static_cast<T>(i);
    } else {
      from_value(found->second, field);
    }
  }

 private:
  const ValueMap& values_;
};

}  // namespace detail

/// The parameters that a struct declares, in the order of its describe lines.
template <class P>
std::vector<ParameterInfo> schema_of() {
  P defaults;
  detail::SchemaVisitor visitor;
  defaults.describe(visitor);
  return std::move(visitor.parameters);
}

/// Throws ParameterError if a name is unknown, a value refused or, with `complete`, a required one missing.
void validate(const std::vector<ParameterInfo>& schema, const ValueMap& values, bool complete = true);

/// Throws ParameterError if one of `changes` belongs to a parameter that is not declared live.
void require_live(const std::vector<ParameterInfo>& schema, const ValueMap& changes);

/// Gives the fields that `values` names new values, which must have passed validate().
template <class P>
void set_parameters(P& parameters, const ValueMap& values) {
  detail::LoadVisitor visitor(values);
  parameters.describe(visitor);
}

/// A struct of parameters filled from `values`, which must have passed validate().
template <class P>
P load_parameters(const ValueMap& values) {
  P parameters;
  set_parameters(parameters, values);
  return parameters;
}

namespace detail {

/// A struct of parameters, whatever its type, that can be filled anew.
class ParameterHolder {
 public:
  virtual ~ParameterHolder() = default;
  virtual void load(const ValueMap& values) = 0;
};

template <class P>
class HeldParameters final : public ParameterHolder {
 public:
  explicit HeldParameters(const ValueMap& values) : parameters(load_parameters<P>(values)) {}
  void load(const ValueMap& values) override { parameters = load_parameters<P>(values); }

  P parameters;
};

}  // namespace detail

}  // namespace kervan
