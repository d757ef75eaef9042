/// A configuration file as a small tree in which every value knows where it was written, so that every refusal can say
/// `file:line:column: key: what is wrong and what to write instead`.
///
///   const config::Node world = config::load("worlds/lab.yaml");
///   world.only_keys({"name", "walls"});
///   for (const config::Node& wall : world.required("walls").list()) add_wall(wall.required("from").as_point(), …);
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/component/error.hpp"
#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::config {

enum class Kind { null, scalar, list, map };

/// One value of the file with everything below it. All accessors throw ConfigError at the node's own place when the
/// value is not what they promise; none of them guesses.
struct Node {
  Kind kind = Kind::null;
  std::string name;                 ///< its key in a map, `start[2]` in a list, empty at the top
  std::string text;                 ///< of a scalar, without quotes
  bool quoted = false;              ///< a quoted scalar is a text, never a number or a boolean
  std::string written;              ///< what stood here before `${arg}` was replaced; empty if nothing was
  Location location;                ///< where the value begins
  Location key_location;            ///< where its key begins; the value's own place outside of a map
  std::vector<Node> children = {};  ///< of a list or a map, in the file's order

  bool is_map() const { return kind == Kind::map; }
  bool is_list() const { return kind == Kind::list; }
  bool is_scalar() const { return kind == Kind::scalar; }

  /// The values of a map (each has its key as `name`), or the items of a list.
  const std::vector<Node>& map() const;
  const std::vector<Node>& list() const;
  const std::vector<Node>& list_of(std::size_t count, std::string_view what) const;  ///< e.g. (2, "[x, y]")

  const Node& required(std::string_view key) const;
  const Node* optional(std::string_view key) const;  ///< nullptr if the map has no such key
  void only_keys(const std::vector<std::string>& allowed) const;

  bool as_bool() const;             ///< `true` or `false`, and no other spelling
  std::int64_t as_integer() const;  ///< decimal, without leading zeros
  double as_number() const;         ///< a finite number without a unit
  std::string as_text() const;      ///< any scalar
  std::string as_choice(const std::vector<std::string>& choices) const;

  /// A number with a unit, converted to the SI unit `unit` ("m", "rad/s", …; quantity.hpp lists what may be written).
  /// With an empty `unit` the same as as_number().
  double as_quantity(std::string_view unit) const;
  Duration as_duration() const;
  std::vector<double> as_quantities(std::string_view unit) const;  ///< a list of them
  geometry::Vector2 as_point() const;                              ///< `[1.0 m, 2.0 m]`
  geometry::Pose2 as_pose() const;                                 ///< `[1.0 m, 2.0 m, 90 deg]`

  /// The node that `path` (`robots.r1.start[2]`) leads to, or the last one on the way if it leads nowhere.
  const Node& nearest_to(std::string_view path) const;

  /// Throws ConfigError here: "name: message".
  [[noreturn]] void fail(const std::string& message) const;
  /// The same at the node's key, for a key that should not be there.
  [[noreturn]] void fail_at_key(const std::string& message) const;

  /// The scalar as a person wrote it, for messages: `"lab"`, `0.5`, `1 (from ${seed})`; "a list" and so on for others.
  std::string shown() const;
};

/// A scalar that was not read from a file, such as a command line argument; `origin` stands where a file would.
Node scalar(std::string text, std::string name, std::string origin);

/// Reads a file, strictly: YAML without anchors, aliases, tags, merge keys, duplicate keys, tabs as indentation and
/// second documents. Throws ConfigError. `shown_as` is the name in messages, the path itself unless given.
Node load(const std::string& path, const std::string& shown_as = {});

/// The same for a text in memory.
Node parse(const std::string& text, const std::string& shown_as);

/// "; did you mean 'color'?" if one of `known` is near `word`, else nothing.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

/// The end of a message about an unknown `word`: "; did you mean 'color'? allowed: color, size", or without a near one
/// "; allowed: color, size". `label` introduces the list.
std::string hint(const std::string& word, const std::vector<std::string>& known, const std::string& label);

/// "a, b, c", for lists of what is allowed; "none" if there is nothing.
std::string joined(const std::vector<std::string>& words);

}  // namespace kervan::config
