// Arrays and attributes in HDF5 files, where the library is present. A file has its name only when
// it is whole.
#pragma once

#include <mpmpbd/io/file.hpp>

#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/ranges.h>

#define MPMPBD_HAS_HDF5 1

namespace mpmpbd::io {

namespace detail {

// Owns what HDF5 has opened; `close` is its own kind of H5?close.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t), std::string const& what) : id_(id), close_(close) {
    if (id < 0) throw FileError("HDF5 cannot " + what);
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle(Hdf5Handle const&) = delete;
  Hdf5Handle& operator=(Hdf5Handle const&) = delete;
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  ~Hdf5Handle() { release(); }
  operator hid_t() const { return id_; }
  bool release() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <class E> hid_t hdf5_type() {
  if constexpr (std::is_same_v<E, float>)
    return H5T_NATIVE_FLOAT;
  else if constexpr (std::is_same_v<E, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::is_same_v<E, std::uint8_t>)
    return H5T_NATIVE_UINT8;
  else {
    static_assert(std::is_same_v<E, std::int64_t>,
                  "mpmpbd HDF5: arrays are of float, double, uint8 or int64; convert the others");
    return H5T_NATIVE_INT64;
  }
}

// What a call of HDF5 returns. It prints what is wrong by itself, to the whole process; here an
// exception says it.
template <class Call> auto quietly(Call&& call) {
  H5E_auto2_t print = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  auto const result = call();
  H5Eset_auto2(H5E_DEFAULT, print, data);
  return result;
}

// Rows of an array that are compressed together: about 64 KiB.
inline std::vector<hsize_t> hdf5_chunk(std::vector<hsize_t> shape, std::size_t element_size) {
  hsize_t row = element_size;
  for (std::size_t a = 1; a < shape.size(); ++a) row *= shape[a];
  shape[0] = std::min(shape[0], std::max(hsize_t{1}, hsize_t{65536} / row));
  return shape;
}

// Bytes that deflate can make of one, at the most.
inline constexpr hsize_t most_deflated = 1032;

// The number of values that a shape has places for; nothing when there are more than `most`.
inline std::optional<std::size_t> hdf5_count(std::vector<hsize_t> const& shape, std::size_t most) {
  std::size_t n = std::ranges::find(shape, hsize_t{0}) == shape.end() ? 1 : 0;
  for (auto s : shape) {
    if (s > 0 && n > most / s) return std::nullopt;
    n *= static_cast<std::size_t>(s);
  }
  return n <= most ? std::optional(n) : std::nullopt;
}

// Refuses numbers of a file that are of another class (whole, with a fraction, none) than is asked for.
inline void check_hdf5_class(hid_t stored, hid_t wanted, std::string const& what) {
  auto const wants = H5Tget_class(wanted);
  if (H5Tget_class(stored) != wants)
    throw FileError(
        fmt::format("HDF5 cannot read {}: it does not hold {}", what,
                    wants == H5T_INTEGER ? "whole numbers" : "numbers with a fraction"));
}

}  // namespace detail

// A group of an HDF5 file: arrays, attributes and groups inside it.
class Hdf5Group {
 public:
  explicit Hdf5Group(detail::Hdf5Handle id) : id_(std::move(id)) {}

  Hdf5Group group(std::string const& name) const {
    return Hdf5Group({H5Gcreate2(id_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      H5Gclose, "make the group '" + name + "'"});
  }
  Hdf5Group open(std::string const& name) const {
    return Hdf5Group({detail::quietly([&] { return H5Gopen2(id_, name.c_str(), H5P_DEFAULT); }),
                      H5Gclose, "open the group '" + name + "'; is it a file of this kind?"});
  }

  // An array of this shape, compressed where it is large.
  template <class E>
  void write(std::string const& name, std::vector<hsize_t> const& shape,
             std::span<E const> values) {
    if (detail::hdf5_count(shape, values.size()) != values.size())
      throw FileError(
          fmt::format("HDF5 cannot write the array '{}': {} values given for a shape of {}; give "
                      "one for each of its places",
                      name, values.size(), fmt::join(shape, " x ")));
    detail::Hdf5Handle const space(
        H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
        "describe the array '" + name + "'");
    detail::Hdf5Handle const how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "set up an array");
    if (values.size() >= 65536 && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
      auto const chunk = detail::hdf5_chunk(shape, sizeof(E));
      if (H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data()) < 0 ||
          H5Pset_deflate(how, 4) < 0)
        throw FileError("HDF5 cannot compress the array '" + name + "'");
    }
    auto const type = detail::hdf5_type<E>();
    detail::Hdf5Handle const array(
        H5Dcreate2(id_, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose,
        "make the array '" + name + "'");
    if (!values.empty() && H5Dwrite(array, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      throw FileError("HDF5 cannot write the array '" + name + "'");
  }

  // The numbers of an array, in the order of its axes, and its shape.
  template <class E>
  std::vector<E> read(std::string const& name, std::vector<hsize_t>* shape = nullptr) const {
    detail::Hdf5Handle const array(
        detail::quietly([&] { return H5Dopen2(id_, name.c_str(), H5P_DEFAULT); }), H5Dclose,
        "open the array '" + name + "'");
    detail::Hdf5Handle const space(H5Dget_space(array), H5Sclose,
                                   "measure the array '" + name + "'");
    int const axes = H5Sget_simple_extent_ndims(space);
    if (axes < 0) throw FileError("HDF5 cannot measure the array '" + name + "'");
    std::vector<hsize_t> sizes(static_cast<std::size_t>(axes));
    H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
    detail::Hdf5Handle const stored(H5Dget_type(array), H5Tclose,
                                    "tell the numbers of the array '" + name + "'");
    detail::check_hdf5_class(stored, detail::hdf5_type<E>(), "the array '" + name + "'");
    // Nothing is allocated for numbers that the file only claims to hold.
    auto const n = detail::hdf5_count(
        sizes, H5Dget_storage_size(array) / H5Tget_size(stored) * detail::most_deflated);
    if (!n)
      throw FileError(fmt::format(
          "HDF5 cannot read the array '{}': it has the shape {}, for which the file does not hold "
          "enough numbers; is it whole?",
          name, fmt::join(sizes, " x ")));
    std::vector<E> values(*n);
    if (!values.empty() &&
        H5Dread(array, detail::hdf5_type<E>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      throw FileError("HDF5 cannot read the array '" + name + "'");
    if (shape != nullptr) *shape = sizes;
    return values;
  }

  void attribute(std::string const& name, std::int64_t value) {
    detail::Hdf5Handle const space(H5Screate(H5S_SCALAR), H5Sclose, "describe a number");
    write_attribute(name, H5T_NATIVE_INT64, space, &value);
  }
  void attribute(std::string const& name, std::string const& text) {
    detail::Hdf5Handle const space(H5Screate(H5S_SCALAR), H5Sclose, "describe a text");
    detail::Hdf5Handle const type(H5Tcopy(H5T_C_S1), H5Tclose, "describe a text");
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    char const* const first = text.c_str();
    write_attribute(name, type, space, &first);
  }
  std::int64_t integer(std::string const& name) const {
    detail::Hdf5Handle const a(
        detail::quietly([&] { return H5Aopen(id_, name.c_str(), H5P_DEFAULT); }), H5Aclose,
        "open the attribute '" + name + "'");
    detail::Hdf5Handle const space(H5Aget_space(a), H5Sclose,
                                   "measure the attribute '" + name + "'");
    detail::Hdf5Handle const stored(H5Aget_type(a), H5Tclose,
                                    "tell the numbers of the attribute '" + name + "'");
    detail::check_hdf5_class(stored, H5T_NATIVE_INT64, "the attribute '" + name + "'");
    if (auto const count = H5Sget_simple_extent_npoints(space); count != 1)
      throw FileError(fmt::format(
          "HDF5 cannot read the attribute '{}': it holds {} numbers, not one", name, count));
    std::int64_t value = 0;
    if (H5Aread(a, H5T_NATIVE_INT64, &value) < 0)
      throw FileError("HDF5 cannot read the attribute '" + name + "'");
    return value;
  }

 protected:
  void write_attribute(std::string const& name, hid_t type, hid_t space, void const* value) {
    detail::Hdf5Handle const a(H5Acreate2(id_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose, "make the attribute '" + name + "'");
    if (H5Awrite(a, type, value) < 0)
      throw FileError("HDF5 cannot write the attribute '" + name + "'");
  }

  detail::Hdf5Handle id_;
};

// A new file; close() gives it its name. Without, it stays `<path>.part`.
class Hdf5Writer : public Hdf5Group {
 public:
  explicit Hdf5Writer(Path const& path) : Hdf5Group(create(path)), path_(path) {}
  void close() {
    if (!id_.release()) throw FileError("HDF5 cannot close '" + path_.string() + "'");
    std::filesystem::rename(part(path_), path_);
  }

 private:
  static Path part(Path path) { return path += ".part"; }
  static detail::Hdf5Handle create(Path const& path) {
    return {detail::quietly([&] {
              return H5Fcreate(part(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
            }),
            H5Fclose, "write '" + path.string() + "'; give a path in a folder that exists"};
  }
  Path path_;
};

class Hdf5Reader : public Hdf5Group {
 public:
  explicit Hdf5Reader(Path const& path)
      : Hdf5Group(
            {open_file(path), H5Fclose, "read '" + path.string() + "'; is it an HDF5 file?"}) {}

 private:
  static hid_t open_file(Path const& path) {
    return detail::quietly([&] { return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT); });
  }
};

}  // namespace mpmpbd::io
#endif
