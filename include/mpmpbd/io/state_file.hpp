// A whole state in one binary file: versioned, described by its own fields, closed by a checksum.
//
// Reading builds a new State and returns it only when every check has passed, so a bad file changes
// nothing. Layout: magic, version, description (scalar size, domains, fields), live counts, planes,
// 64-bit FNV-1a of all bytes before it. Little-endian.
#pragma once

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/io/printable.hpp>

namespace mpmpbd {

static_assert(std::endian::native == std::endian::little,
              "mpmpbd state files are little-endian; this machine is not");

inline constexpr std::string_view state_file_magic = "MPMPBDST";
inline constexpr std::uint32_t state_file_version = 1;

namespace detail {

// 64-bit FNV-1a: detects truncation and corruption, not tampering.
inline std::uint64_t fnv1a(char const* bytes, std::size_t count) {
  std::uint64_t hash = 14695981039346656037ull;
  for (std::size_t i = 0; i < count; ++i) {
    hash ^= static_cast<unsigned char>(bytes[i]);
    hash *= 1099511628211ull;
  }
  return hash;
}

class ByteWriter {
 public:
  template <class V> void put(V const& v) {
    static_assert(std::is_trivially_copyable_v<V>);
    put_bytes(&v, sizeof v);
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put_bytes(text.data(), text.size());
  }
  void put_bytes(void const* data, std::size_t count) {
    auto const* c = static_cast<char const*>(data);
    bytes.insert(bytes.end(), c, c + count);
  }
  std::vector<char> bytes;
};

class ByteReader {
 public:
  ByteReader(std::string file, std::vector<char> const& bytes, std::size_t end)
      : file_(std::move(file)), bytes_(bytes), end_(end) {}
  template <class V> V get() {
    V v;
    get_bytes(&v, sizeof v);
    return v;
  }
  std::string get_text() {
    auto const size = get<std::uint32_t>();
    need(size);
    std::string text(bytes_.data() + at_, size);
    at_ += size;
    return text;
  }
  void get_bytes(void* to, std::size_t count) {
    need(count);
    if (count > 0) std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
  }
  bool at_end() const { return at_ == end_; }
  std::size_t left() const { return end_ - at_; }

 private:
  void need(std::size_t count) const {
    if (count > end_ - at_)
      throw std::runtime_error("mpmpbd state file '" + file_ + "': truncated at byte " +
                               std::to_string(end_) + "; nothing was changed, save it again");
  }
  std::string file_;
  std::vector<char> const& bytes_;
  std::size_t at_ = 0;
  std::size_t end_;
};

// What a state of this type looks like, in words; equal descriptions can exchange files.
template <class Store> std::string describe_state() {
  std::string text = "scalar " + std::to_string(sizeof(typename Store::Scalar)) + "\n";
  for_each_field(typename Store::List{}, [&]<class F>(F) {
    text += std::string(F::Domain::name.view()) + "." + std::string(F::name.view()) + " [" +
            std::string(F::unit.view()) + "] x" + std::to_string(F::components) + " of " +
            std::to_string(sizeof(element_t<F, typename Store::Scalar>)) + " B\n";
  });
  return text;
}

[[noreturn]] inline void refuse_state_file(std::string const& file, std::string const& why) {
  throw std::runtime_error("mpmpbd state file '" + file + "': " + why + "; nothing was changed");
}

// The first line in which two descriptions differ.
inline std::string first_difference(std::string const& given, std::string const& wanted) {
  std::size_t line = 0;
  for (std::size_t i = 0; i < given.size() && i < wanted.size() && given[i] == wanted[i]; ++i)
    if (given[i] == '\n') line = i + 1;
  auto const rest = [line](std::string const& s) {
    return line < s.size() ? io::printable(s.substr(line, s.find('\n', line) - line))
                           : std::string("nothing");
  };
  return "it holds '" + rest(given) + "' where this scene has '" + rest(wanted) + "'";
}

inline std::vector<char> read_all(std::string const& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) refuse_state_file(file, "cannot be opened");
  if (!std::filesystem::is_regular_file(file)) refuse_state_file(file, "is not a file");
  std::vector<char> bytes(static_cast<std::size_t>(in.tellg()));
  in.seekg(0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in) refuse_state_file(file, "cannot be read");
  return bytes;
}

// Refuses a number of items for which the rest of the file is too short: nothing is allocated for it.
inline void check_count(ByteReader const& in, std::string const& file, std::int64_t count,
                        std::size_t bytes_each) {
  if (count < 0 || (bytes_each > 0 && static_cast<std::size_t>(count) > in.left() / bytes_each))
    refuse_state_file(file,
                      "describes " + std::to_string(count) + " items, which it does not hold");
}

template <class Table_>
void read_table(ByteReader& in, std::string const& file, std::int64_t environments, Table_& table) {
  auto const capacity = in.get<std::int64_t>();
  check_count(in, file, capacity, static_cast<std::size_t>(environments) * Table_::bytes_per_item);
  table.resize(environments, capacity);
  for (std::int64_t e = 0; e < environments; ++e) {
    auto const live = in.get<std::int64_t>();
    if (live < 0 || live > capacity)
      refuse_state_file(
          file, "has " + std::to_string(live) + " items in use, of " + std::to_string(capacity));
    table.set_live(e, live);
  }
  for_each_field(typename Table_::List{}, [&]<class F>(F) {
    auto& plane = table.template planes<F>();
    in.get_bytes(plane.data(), plane.size() * sizeof(plane[0]));
  });
}

}  // namespace detail

// Writes all environments of a state. Throws std::runtime_error when the file cannot be written; an
// older file of the name is replaced only by a complete new one.
template <class T, class List>
void write_state_file(std::string const& file, State<T, List> const& state) {
  using Store = State<T, List>;
  detail::ByteWriter out;
  out.put_bytes(state_file_magic.data(), state_file_magic.size());
  out.put(state_file_version);
  out.put_text(detail::describe_state<Store>());
  out.put(state.environments());
  for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
    auto const& table = state.template table<D>();
    out.put(table.capacity());
    for (std::int64_t e = 0; e < state.environments(); ++e) out.put(table.live(e));
    for_each_field(on_t<typename Store::List, D>{}, [&]<class F>(F) {
      auto const& plane = table.template planes<F>();
      out.put_bytes(plane.data(), plane.size() * sizeof(plane[0]));
    });
  });
  out.put(detail::fnv1a(out.bytes.data(), out.bytes.size()));

  auto const partial = file + ".part";
  std::ofstream stream(partial, std::ios::binary);
  stream.write(out.bytes.data(), static_cast<std::streamsize>(out.bytes.size()));
  stream.close();
  if (!stream)
    throw std::runtime_error("mpmpbd state file '" + file +
                             "': cannot be written; check the folder and the free space");
  std::filesystem::rename(partial, file);
}

// Reads a state written by the same scene and scalar type. Throws std::runtime_error that says what is
// wrong when the file is missing, truncated, corrupted, foreign, of another version or another scene.
template <class Store> Store read_state_file(std::string const& file) {
  auto const bytes = detail::read_all(file);
  if (bytes.size() < state_file_magic.size() ||
      std::string_view(bytes.data(), state_file_magic.size()) != state_file_magic)
    detail::refuse_state_file(file, "is not a state file of mpmpbd");
  if (bytes.size() < state_file_magic.size() + sizeof(std::uint32_t) + sizeof(std::uint64_t))
    detail::refuse_state_file(file, "is truncated");
  std::size_t const end = bytes.size() - sizeof(std::uint64_t);
  detail::ByteReader in(file, bytes, end);
  char magic[state_file_magic.size()];
  in.get_bytes(magic, sizeof magic);
  auto const version = in.get<std::uint32_t>();
  if (version != state_file_version)
    detail::refuse_state_file(file, "has format version " + std::to_string(version) +
                                        ", this library reads version " +
                                        std::to_string(state_file_version));
  std::uint64_t checksum;
  std::memcpy(&checksum, bytes.data() + end, sizeof checksum);
  if (checksum != detail::fnv1a(bytes.data(), end))
    detail::refuse_state_file(file, "is truncated or corrupted (its checksum does not match)");
  auto const description = in.get_text();
  if (description != detail::describe_state<Store>())
    detail::refuse_state_file(
        file, "belongs to another scene: " +
                  detail::first_difference(description, detail::describe_state<Store>()));
  auto const environments = in.get<std::int64_t>();
  detail::check_count(in, file, environments, sizeof(std::int64_t));
  Store state(environments);
  for_each_type(typename Store::Domains{}, [&]<class D>(std::type_identity<D>) {
    detail::read_table(in, file, environments, state.template table<D>());
  });
  if (!in.at_end()) detail::refuse_state_file(file, "holds more bytes than it describes");
  return state;
}

}  // namespace mpmpbd
