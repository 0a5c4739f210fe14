// Settings from TOML files, strictly: what a file says is understood completely or refused, with file,
// line, key, value and what is allowed. Through toml++ where it is present.
#pragma once

#include <mpmpbd/io/config_keys.hpp>
#include <mpmpbd/io/file.hpp>
#include <mpmpbd/io/printable.hpp>

namespace mpmpbd::io {

// The settings as a commented TOML file that reads back to the same settings, bit for bit.
template <class C> std::string config_text(C const& config) {
  C copy = config;
  auto const all = config_keys(copy);
  std::string text;
  for (auto const& table : all.tables()) {
    if (!table.name.empty())
      text += fmt::format("{}# {}\n[{}]\n", text.empty() ? "" : "\n", table.docs, table.name);
    std::string const prefix = table.name.empty() ? "" : table.name + ".";
    for (auto const& key : all.keys()) {
      if (key.name != prefix + std::string(key.bounds.name)) continue;
      text += fmt::format("{} = {}  # {}; {}\n", key.bounds.name,
                          mpmpbd::detail::config_value_text(key.target), key.docs,
                          mpmpbd::detail::wanted_text(key));
    }
  }
  return text;
}

// Writes them beside the results, so that a run can be repeated.
template <class C> void write_config(Path const& path, C const& config) {
  write_file(path, config_text(config));
}

}  // namespace mpmpbd::io

#if __has_include(<toml++/toml.h>)
#include <toml++/toml.h>

#include <algorithm>
#include <limits>

namespace mpmpbd::io {

namespace detail {

// Insertions, deletions and replacements that lead from one text to another.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      std::size_t const replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replace, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

// Fills the keys of one struct from TOML documents and collects every complaint.
class ConfigReader {
 public:
  explicit ConfigReader(ConfigKeys const& keys) : keys_(keys), seen_(keys.keys().size()) {}

  // Several documents may follow each other: the later one wins. `source` stands in the messages.
  void read(std::string_view text, std::string const& source) {
    sources_.push_back(source);
    bool const one_line = text.find('\n') == std::string_view::npos;
    has_lines_.push_back(!one_line);
    if (auto const line = line_of_many_dots(text)) {
      say(line, fmt::format("more than {} dots in a line; a key has one or two", most_dots));
      unreadable_ = true;
      return;
    }
    try {
      auto const document = toml::parse(text, std::string_view(source));
      walk(static_cast<toml::table const&>(document), "");
    } catch (toml::parse_error const& error) {
      say(error.source().begin.line, std::string(error.description()) + "; write TOML 1.0");
      unreadable_ = true;
    }
  }

  // Keys that must be given and were not.
  void finish() {
    if (unreadable_) return;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      auto const& key = keys_.keys()[i];
      if (!key.required || seen_[i].document >= 0) continue;
      say(0, fmt::format("key {} is missing; give {}, {}", key.name,
                         mpmpbd::detail::wanted_text(key), key.docs));
      flawed_.push_back(key.name);
    }
  }

  void judge(std::vector<ConfigRules::Broken> const& broken) {
    for (auto const& one : broken) {
      Place at = here(0);
      bool given = false;
      for (std::size_t i = 0; i < seen_.size(); ++i)
        if (keys_.keys()[i].name == one.key && seen_[i].document >= 0) {
          at = seen_[i];
          given = true;
        }
      complaints_.push_back({at, fmt::format("{} = {}{}", one.key, one.text,
                                             given ? "" : " (the value is the default)")});
    }
  }

  std::vector<std::string> const& flawed() const { return flawed_; }
  // In the order of the documents and their lines.
  std::vector<std::string> messages() const {
    auto sorted = complaints_;
    std::stable_sort(sorted.begin(), sorted.end(), [](Complaint const& a, Complaint const& b) {
      return a.at.document != b.at.document ? a.at.document < b.at.document : a.at.line < b.at.line;
    });
    std::vector<std::string> all;
    all.reserve(sorted.size());
    for (auto const& one : sorted) all.push_back(place(one.at) + ": " + one.text);
    return all;
  }

 private:
  // toml++ takes a table apart with a call per table in it: dots without end in a key would fill the stack.
  static constexpr int most_dots = 100;
  static std::uint32_t line_of_many_dots(std::string_view text) {
    std::uint32_t line = 1;
    int dots = 0;
    for (char const c : text) {
      if (c == '.' && ++dots > most_dots) return line;
      if (c != '\n') continue;
      ++line;
      dots = 0;
    }
    return 0;
  }

  struct Place {
    int document = -1;  // -1: nowhere
    std::uint32_t line = 0;
  };
  struct Complaint {
    Place at;
    std::string text;
  };

  std::string place(Place const& at) const {
    if (at.document < 0) return "settings without a document";
    auto const& source = sources_[static_cast<std::size_t>(at.document)];
    return at.line == 0 || !has_lines_[static_cast<std::size_t>(at.document)]
               ? source
               : fmt::format("{}:{}", source, at.line);
  }
  Place here(std::uint32_t line) const { return {static_cast<int>(sources_.size()) - 1, line}; }
  void say(std::uint32_t line, std::string text) {
    complaints_.push_back({here(line), printable(std::move(text))});
  }

  bool is_table(std::string const& name) const {
    for (auto const& t : keys_.tables())
      if (t.name == name) return true;
    return false;
  }

  void walk(toml::table const& table, std::string const& prefix) {
    for (auto const& [word, node] : table) {
      std::string const name = prefix + std::string(word.str());
      // The line of the key, not of its value: an array may open on a later line.
      std::uint32_t const line = word.source().begin.line;
      if (is_table(name)) {
        if (auto const* inner = node.as_table())
          walk(*inner, name + ".");
        else
          say(line, fmt::format("{} is {}; it is a table, write [{}]", name, kind(node), name));
        continue;
      }
      std::size_t i = 0;
      while (i < seen_.size() && keys_.keys()[i].name != name) ++i;
      if (i < seen_.size())
        take(i, node, line);
      else
        unknown(name, node, line);
    }
  }

  void unknown(std::string const& name, toml::node const& node, std::uint32_t line) {
    bool const table = node.is_table();
    std::string best;
    std::size_t least = std::string::npos;
    auto last = [](std::string const& full) { return full.substr(full.rfind('.') + 1); };
    auto offer = [&](std::string const& known) {
      std::size_t const d =
          std::min(edit_distance(name, known), edit_distance(last(name), last(known)) + 1);
      if (d < least) {
        least = d;
        best = known;
      }
    };
    if (table) {
      for (auto const& t : keys_.tables())
        if (!t.name.empty()) offer(t.name);
    } else {
      for (auto const& k : keys_.keys()) offer(k.name);
    }
    std::string advice = "take it out";
    if (least <= std::max<std::size_t>(2, last(name).size() / 3))
      advice = fmt::format("did you mean {}?", best);
    say(line, fmt::format("{} {} is not known; {}", table ? "table" : "key", name, advice));
  }

  void take(std::size_t i, toml::node const& node, std::uint32_t line) {
    auto const& key = keys_.keys()[i];
    seen_[i] = here(line);
    bool const fits =
        std::visit([&](auto* target) { return assign(key, node, *target); }, key.target);
    if (fits) {
      std::erase(flawed_, key.name);
      return;
    }
    if (refused_.empty())
      say(line, fmt::format("{} = {} is {}; give {}", key.name, shown(node), kind(node),
                            mpmpbd::detail::wanted_text(key)));
    else
      say(line, fmt::format("{} = {}", key.name, mpmpbd::detail::not_allowed(refused_, key)));
    refused_.clear();
    flawed_.push_back(key.name);
  }

  // Each of these returns whether the value was taken; a value of the right type that is out of
  // bounds is left in `refused_`. A key keeps its default then.
  template <class Number> bool number(ConfigKey const& key, toml::node const& node, Number& out) {
    bool const whole = !std::is_same_v<Number, double>;
    if (!node.is_integer() && (whole || !node.is_floating_point())) return false;
    // As a double for the bounds. toml++ gives none for a whole number that it would round.
    auto const* const integer = node.as_integer();
    std::int64_t const exact = integer != nullptr ? integer->get() : 0;
    double const value =
        integer != nullptr ? static_cast<double>(exact) : node.value<double>().value_or(0.0);
    bool fits = mpmpbd::detail::allows(key.bounds, value);
    if constexpr (std::is_same_v<Number, double>) {
      if (fits) out = value;
    } else {
      fits = fits && exact >= std::numeric_limits<Number>::min() &&
             exact <= std::numeric_limits<Number>::max();
      if (fits) out = static_cast<Number>(exact);
    }
    if (!fits) refused_ = shown(node);
    return fits;
  }
  bool assign(ConfigKey const& key, toml::node const& node, double& out) {
    return number(key, node, out);
  }
  bool assign(ConfigKey const& key, toml::node const& node, int& out) {
    return number(key, node, out);
  }
  bool assign(ConfigKey const& key, toml::node const& node, std::int64_t& out) {
    return number(key, node, out);
  }
  bool assign(ConfigKey const&, toml::node const& node, bool& out) {
    if (!node.is_boolean()) return false;
    out = node.value<bool>().value_or(false);
    return true;
  }
  bool assign(ConfigKey const& key, toml::node const& node, std::string& out) {
    if (!node.is_string()) return false;
    auto const text = node.value<std::string>().value_or("");
    bool fits = key.choices.empty();
    for (auto const& one : key.choices) fits = fits || one == text;
    if (fits)
      out = text;
    else
      refused_ = shown(node);
    return fits;
  }
  template <class Number>
  bool assign(ConfigKey const& key, toml::node const& node, Vec3<Number>& out) {
    auto const* const array = node.as_array();
    if (array == nullptr || array->size() != 3) return false;
    Vec3<Number> all{};
    for (std::size_t a = 0; a < 3; ++a)
      if (!number(key, *array->get(a), all[static_cast<int>(a)])) {
        if (!refused_.empty()) refused_ = shown(node);
        return false;
      }
    out = all;
    return true;
  }

  static std::string kind(toml::node const& node) {
    if (node.is_string()) return "a text";
    if (node.is_integer()) return "a whole number";
    if (node.is_floating_point()) return "a number with a fraction";
    if (node.is_boolean()) return "a truth value";
    if (auto const* array = node.as_array()) return fmt::format("a list of {}", array->size());
    if (node.is_table()) return "a table";
    return "a date or time";
  }
  static std::string shown(toml::node const& node) {
    if (node.is_integer()) return fmt::format("{}", node.value<std::int64_t>().value_or(0));
    if (node.is_floating_point()) return fmt::format("{:#}", node.value<double>().value_or(0.0));
    if (node.is_boolean()) return node.value<bool>().value_or(false) ? "true" : "false";
    if (node.is_string()) return "\"" + node.value<std::string>().value_or("") + "\"";
    if (auto const* array = node.as_array()) {
      std::string text;
      for (auto const& one : *array) text += (text.empty() ? "" : ", ") + shown(one);
      return "[" + text + "]";
    }
    return "...";
  }

  ConfigKeys const& keys_;
  std::vector<Place> seen_;
  std::vector<std::string> flawed_;
  std::vector<Complaint> complaints_;
  std::vector<std::string> sources_;
  std::vector<bool> has_lines_;  // a document of one line is named without it
  std::string refused_;
  bool unreadable_ = false;
};

}  // namespace detail

// One TOML document and the name under which messages speak of it.
struct ConfigSource {
  std::string text;
  std::string name;
};

// Settings from documents, the later ones over the earlier ones; keys that none mentions keep their
// default. Throws ConfigError with every mistake of all documents, and then nothing is returned.
template <class C> C parse_config(std::vector<ConfigSource> const& sources) {
  C config{};
  auto const keys = config_keys(config);
  detail::ConfigReader reader(keys);
  for (auto const& source : sources) reader.read(source.text, source.name);
  reader.finish();
  if constexpr (requires(ConfigRules & rules) { config.check(rules); }) {
    // A key that was refused holds its default, so the rest can still be judged.
    ConfigRules rules(keys.keys(), reader.flawed());
    config.check(rules);
    reader.judge(rules.broken());
  }
  if (auto messages = reader.messages(); !messages.empty()) throw ConfigError(std::move(messages));
  return config;
}
template <class C> C parse_config(std::string const& text, std::string const& name) {
  return parse_config<C>({{text, name}});
}

// Settings from files, the later ones over the earlier ones, and from lines `table.key = value` that are laid over
// them (a program's --set).
template <class C>
C read_config(std::vector<Path> const& paths, std::vector<std::string> const& overrides = {}) {
  std::vector<ConfigSource> sources;
  for (auto const& path : paths) sources.push_back({read_file(path), path.string()});
  for (auto const& line : overrides) sources.push_back({line, "--set"});
  return parse_config<C>(sources);
}
template <class C> C read_config(Path const& path, std::vector<std::string> const& overrides = {}) {
  return read_config<C>(std::vector<Path>{path}, overrides);
}

}  // namespace mpmpbd::io
#endif
