// How a struct of settings declares its keys: once, for reading, checking, writing and documentation.
//
//   struct Wire {
//     double radius = 0.001;
//     int beads = 20;
//     void declare(ConfigKeys& keys) {
//       keys(radius, bound::positive("radius_m", "m"), "radius of the wire");
//       keys(beads, bound::between("beads", "1", 2, 1000), "points along it");
//     }
//     void check(ConfigRules& rules) const {  // what the keys mean together; may be left out
//       rules.number("radius_m", radius, {.high = 0.1}, "the wire fits into the domain");
//     }
//   };
//
// No file format in here: io/config.hpp reads and writes it as TOML.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/core/parameters.hpp>

namespace mpmpbd {

// One key: its full name ("tissue.density_kg_m3"), what it means, and where its value lives.
struct ConfigKey {
  using Target =
      std::variant<double*, int*, std::int64_t*, bool*, std::string*, Vec3<double>*, Vec<int, 3>*>;
  std::string name;
  Target target;
  ParameterInfo bounds;  // of each number; the name in it is without the table
  std::string docs;
  std::vector<std::string> choices;  // of a string; empty: any text
  bool required = false;
};
struct ConfigTable {
  std::string name;  // empty: the top of the file
  std::string docs;
};

// The keys of a struct, collected by its `declare`.
class ConfigKeys {
 public:
  // Numbers, whole numbers, and vectors of them; bounds hold for each component.
  template <class Value>
    requires(!std::is_same_v<Value, bool> && !std::is_same_v<Value, std::string>)
  ConfigKey& operator()(Value& value, ParameterInfo const& bounds, std::string_view docs) {
    return add(&value, bounds, docs);
  }
  ConfigKey& operator()(bool& value, std::string_view name, std::string_view docs) {
    return add(&value, {name, ""}, docs);
  }
  ConfigKey& operator()(std::string& value, std::string_view name, std::string_view docs,
                        std::vector<std::string> choices = {}) {
    ConfigKey& key = add(&value, {name, ""}, docs);
    key.choices = std::move(choices);
    return key;
  }
  // A key that has no default: `keys.required(...)` with the arguments of `keys(...)`.
  template <class... Arguments> void required(Arguments&&... arguments) {
    (*this)(std::forward<Arguments>(arguments)...).required = true;
  }
  // A struct inside: its keys stand in the table [name].
  template <class Inner> void table(Inner& inner, std::string_view name, std::string_view docs) {
    std::string const outer = prefix_;
    tables_.push_back({outer + std::string(name), std::string(docs)});
    prefix_ = tables_.back().name + ".";
    inner.declare(*this);
    prefix_ = outer;
  }

  std::vector<ConfigKey> const& keys() const { return keys_; }
  std::vector<ConfigTable> const& tables() const { return tables_; }

 private:
  ConfigKey& add(ConfigKey::Target target, ParameterInfo const& bounds, std::string_view docs) {
    keys_.push_back({prefix_ + std::string(bounds.name), target, bounds, std::string(docs), {}});
    return keys_.back();
  }
  std::vector<ConfigKey> keys_;
  std::vector<ConfigTable> tables_{{"", ""}};
  std::string prefix_;
};

// The keys of a settings struct, pointing into it.
template <class C> ConfigKeys config_keys(C& config) {
  ConfigKeys keys;
  config.declare(keys);
  return keys;
}

namespace detail {

// `value` as it is written into a file: a number keeps its type and every digit.
inline std::string config_value_text(ConfigKey::Target const& target) {
  struct Text {
    std::string number(double v) const {
      std::string const text = fmt::format("{}", v);
      return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
    }
    std::string operator()(double* v) const { return number(*v); }
    std::string operator()(int* v) const { return fmt::format("{}", *v); }
    std::string operator()(std::int64_t* v) const { return fmt::format("{}", *v); }
    std::string operator()(bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(std::string* v) const {
      std::string out = "\"";
      for (char const c : *v) {
        auto const code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') out += '\\';
        if (code < 0x20 || code == 0x7f)
          out += fmt::format("\\u{:04X}", static_cast<unsigned>(code));
        else
          out += c;
      }
      return out + '"';
    }
    std::string operator()(Vec3<double>* v) const {
      return fmt::format("[{}, {}, {}]", number((*v)[0]), number((*v)[1]), number((*v)[2]));
    }
    std::string operator()(Vec<int, 3>* v) const {
      return fmt::format("[{}, {}, {}]", (*v)[0], (*v)[1], (*v)[2]);
    }
  };
  return std::visit(Text{}, target);
}

inline std::string unit_text(ParameterInfo const& info) {
  return info.unit.empty() || info.unit == "1" ? "" : fmt::format(" {}", info.unit);
}
inline std::string range_text(ParameterInfo const& info) {
  return fmt::format("{}{}, {}{}", info.low == -bound::none || !info.low_is_allowed ? '(' : '[',
                     info.low, info.high,
                     info.high == bound::none || !info.high_is_allowed ? ')' : ']');
}
inline bool allows(ParameterInfo const& info, double v) {
  bool const above = info.low_is_allowed ? v >= info.low : v > info.low;
  bool const below = info.high_is_allowed ? v <= info.high : v < info.high;
  return above && below && v - v == 0.0;
}
inline std::string choices_text(std::vector<std::string> const& choices) {
  std::string text;
  for (auto const& one : choices) text += (text.empty() ? "\"" : ", \"") + one + "\"";
  return text;
}

// What a key takes, to stand after "give": "a number in (0, inf) Pa".
inline std::string wanted_text(ConfigKey const& key) {
  struct Kind {
    std::string_view operator()(double*) const { return "a number"; }
    std::string_view operator()(int*) const { return "a whole number"; }
    std::string_view operator()(std::int64_t*) const { return "a whole number"; }
    std::string_view operator()(bool*) const { return "true or false"; }
    std::string_view operator()(std::string*) const { return "a text"; }
    std::string_view operator()(Vec3<double>*) const { return "3 numbers, [x, y, z], each"; }
    std::string_view operator()(Vec<int, 3>*) const { return "3 whole numbers, [x, y, z], each"; }
  };
  auto const kind = std::visit(Kind{}, key.target);
  if (std::holds_alternative<bool*>(key.target)) return std::string(kind);
  if (std::holds_alternative<std::string*>(key.target))
    return key.choices.empty() ? std::string(kind) : "one of " + choices_text(key.choices);
  return fmt::format("{} in {}{}", kind, range_text(key.bounds), unit_text(key.bounds));
}

// "300000 Pa is not allowed; give ...": the rest of every complaint about a value.
inline std::string not_allowed(std::string const& value, ConfigKey const& key) {
  return fmt::format("{}{} is not allowed; give {}", value, unit_text(key.bounds),
                     wanted_text(key));
}

// Whether the present value of a key is within its bounds.
inline bool holds_allowed_value(ConfigKey const& key) {
  struct Check {
    ConfigKey const& key;
    bool operator()(double* v) const { return allows(key.bounds, *v); }
    bool operator()(int* v) const { return allows(key.bounds, *v); }
    bool operator()(std::int64_t* v) const { return allows(key.bounds, static_cast<double>(*v)); }
    bool operator()(bool*) const { return true; }
    bool operator()(std::string* v) const {
      bool found = key.choices.empty();
      for (auto const& one : key.choices) found = found || one == *v;
      return found;
    }
    bool operator()(Vec3<double>* v) const {
      return allows(key.bounds, (*v)[0]) && allows(key.bounds, (*v)[1]) &&
             allows(key.bounds, (*v)[2]);
    }
    bool operator()(Vec<int, 3>* v) const {
      return allows(key.bounds, (*v)[0]) && allows(key.bounds, (*v)[1]) &&
             allows(key.bounds, (*v)[2]);
    }
  };
  return std::visit(Check{key}, key.target);
}

}  // namespace detail

// Bounds that follow from other keys.
struct ConfigRange {
  double low = -bound::none;
  double high = bound::none;
};

// What the keys mean together: a struct's `check` states it here, and all that does not hold is
// reported at once.
class ConfigRules {
 public:
  struct Broken {
    std::string key;
    std::string text;  // after "key = "
  };

  ConfigRules(std::vector<ConfigKey> const& keys, std::vector<std::string> const& flawed)
      : keys_(keys), flawed_(flawed) {}

  // The number of a key (or, for a vector, one that follows from it) lies in a range [low, high] that
  // depends on other keys; `because` says how, as a full clause. Refused values of a key are not
  // judged again.
  void number(std::string_view key, double value, ConfigRange const& range,
              std::string_view because) {
    if (value >= range.low && value <= range.high) return;
    ConfigKey const* const k = find(key);
    ParameterInfo info = k != nullptr ? k->bounds : ParameterInfo{key, ""};
    if (range.low > info.low) {
      info.low = range.low;
      info.low_is_allowed = true;
    }
    if (range.high < info.high) {
      info.high = range.high;
      info.high_is_allowed = true;
    }
    break_rule(key, fmt::format("{}{} is not allowed; give a number in {}{}: {}", value,
                                detail::unit_text(info), detail::range_text(info),
                                detail::unit_text(info), because));
  }
  // Anything else: `sentence` says what is wrong and what to give.
  void require(std::string_view key, bool holds, std::string_view sentence) {
    if (holds) return;
    ConfigKey const* const k = find(key);
    auto const value = k == nullptr ? std::string() : detail::config_value_text(k->target);
    auto const unit = k == nullptr ? std::string() : detail::unit_text(k->bounds);
    break_rule(key, fmt::format("{}{} is not allowed; {}", value, unit, sentence));
  }

  std::vector<Broken> const& broken() const { return broken_; }
  // Whether no key and no rule has been refused so far.
  bool all_hold() const { return broken_.empty() && flawed_.empty(); }

 private:
  ConfigKey const* find(std::string_view name) const {
    for (auto const& k : keys_)
      if (k.name == name) return &k;
    return nullptr;
  }
  void break_rule(std::string_view key, std::string text) {
    for (auto const& one : flawed_)
      if (one == key) return;
    broken_.push_back({std::string(key), std::move(text)});
  }

  std::vector<ConfigKey> const& keys_;
  std::vector<std::string> const& flawed_;
  std::vector<Broken> broken_;
};

// Settings that cannot be, all of them: one line each in what() and in `messages`.
struct ConfigError : std::invalid_argument {
  explicit ConfigError(std::vector<std::string> all)
      : std::invalid_argument(joined(all)), messages(std::move(all)) {}
  std::vector<std::string> messages;

 private:
  static std::string joined(std::vector<std::string> const& all) {
    std::string text;
    for (auto const& one : all) text += (text.empty() ? "" : "\n") + one;
    return text;
  }
};

// Refuses settings that were filled in by a program: the same bounds and rules as for a file.
template <class C> void check_config(C const& config) {
  C copy = config;
  auto const keys = config_keys(copy);
  std::vector<std::string> messages, flawed;
  for (auto const& key : keys.keys())
    if (!detail::holds_allowed_value(key)) {
      flawed.push_back(key.name);
      messages.push_back(fmt::format(
          "{} = {}", key.name, detail::not_allowed(detail::config_value_text(key.target), key)));
    }
  if constexpr (requires(ConfigRules & rules) { copy.check(rules); }) {
    if (flawed.empty()) {
      ConfigRules rules(keys.keys(), flawed);
      copy.check(rules);
      for (auto const& b : rules.broken())
        messages.push_back(fmt::format("{} = {}", b.key, b.text));
    }
  }
  if (!messages.empty()) throw ConfigError(std::move(messages));
}

}  // namespace mpmpbd
