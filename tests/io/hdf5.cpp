// Arrays and attributes in HDF5 files: what is written is read, and sizes that cannot be are refused.
#include <mpmpbd/io/hdf5.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

#if defined(MPMPBD_HAS_HDF5)

using namespace mpmpbd;
using Catch::Matchers::Contains;
using io::FileError;

namespace {

// A group in which HDF5 itself writes what the library does not.
class Foreign {
 public:
  explicit Foreign(io::Path const& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, "write") {
  }
  // An array of this shape of which nothing is written.
  void claim(char const* name, std::vector<hsize_t> const& shape) {
    io::detail::Hdf5Handle const space(
        H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, "shape");
    io::detail::Hdf5Handle const how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "set up");
    std::vector<hsize_t> const chunk(shape.size(), 1);
    H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data());
    io::detail::Hdf5Handle const array(
        H5Dcreate2(file_, name, H5T_NATIVE_FLOAT, space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose,
        "make an array");
  }
  void attribute(char const* name, hid_t type, hsize_t count, void const* values) {
    io::detail::Hdf5Handle const space(H5Screate_simple(1, &count, nullptr), H5Sclose, "shape");
    io::detail::Hdf5Handle const a(H5Acreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                                   H5Aclose, "make");
    REQUIRE(H5Awrite(a, type, values) >= 0);
  }

 private:
  io::detail::Hdf5Handle file_;
};

}  // namespace

TEST_CASE("arrays are read as they were written, large and empty ones too", "[io][hdf5]") {
  Scratch const scratch;
  std::vector<float> const zeros(300 * 1000);  // compressed as far as it goes
  std::vector<std::int64_t> const few = {3, -1, 4, 1, -5, 9};
  {
    io::Hdf5Writer file(scratch / "a.hdf5");
    file.write<float>("zeros", {300, 1000}, zeros);
    file.write<std::int64_t>("few", {2, 3}, few);
    file.write<double>("none", {5, 0}, {});
    file.attribute("seed", std::int64_t{7});
    file.close();
  }
  io::Hdf5Reader const file(scratch / "a.hdf5");
  std::vector<hsize_t> shape;
  CHECK(file.read<float>("zeros", &shape) == zeros);
  CHECK(shape == std::vector<hsize_t>{300, 1000});
  CHECK(file.read<std::int64_t>("few") == few);
  CHECK(file.read<double>("none", &shape).empty());
  CHECK(shape == std::vector<hsize_t>{5, 0});
  CHECK(file.integer("seed") == 7);
}

TEST_CASE("an array that claims more numbers than its file holds is refused", "[io][hdf5]") {
  Scratch const scratch;
  {
    Foreign file(scratch / "a.hdf5");
    file.claim("huge", {hsize_t{1} << 40, 1024});
    file.claim("overflow", {hsize_t{1} << 32, hsize_t{1} << 32});  // 2^64 numbers are 0 of them
  }
  io::Hdf5Reader const file(scratch / "a.hdf5");
  CHECK_THAT(complaint<FileError>([&] { file.read<float>("huge"); }),
             Contains("the array 'huge': it has the shape 1099511627776 x 1024"));
  CHECK_THAT(complaint<FileError>([&] { file.read<float>("overflow"); }),
             Contains("the array 'overflow': it has the shape 4294967296 x 4294967296"));
}

TEST_CASE("numbers of another class than asked for are refused", "[io][hdf5]") {
  Scratch const scratch;
  {
    io::Hdf5Writer file(scratch / "a.hdf5");
    file.write<float>("rewards", {2}, std::vector<float>{0.5f, 2.0f});
    file.write<std::uint8_t>("pixels", {2}, std::vector<std::uint8_t>{1, 2});
    file.close();
  }
  io::Hdf5Reader const file(scratch / "a.hdf5");
  CHECK_THAT(complaint<FileError>([&] { file.read<std::int64_t>("rewards"); }),
             Contains("the array 'rewards': it does not hold whole numbers"));
  CHECK_THAT(complaint<FileError>([&] { file.read<float>("pixels"); }),
             Contains("the array 'pixels': it does not hold numbers with a fraction"));
  CHECK(file.read<double>("rewards") == std::vector<double>{0.5, 2.0});
}

TEST_CASE("an attribute that is not one whole number is none", "[io][hdf5]") {
  Scratch const scratch;
  {
    Foreign file(scratch / "a.hdf5");
    std::vector<std::int64_t> const many(1000, 1);
    double const fraction = 1.5;
    file.attribute("many", H5T_NATIVE_INT64, many.size(), many.data());
    file.attribute("fraction", H5T_NATIVE_DOUBLE, 1, &fraction);
    file.attribute("one", H5T_NATIVE_INT64, 1, many.data());
  }
  io::Hdf5Reader const file(scratch / "a.hdf5");
  CHECK_THAT(complaint<FileError>([&] { file.integer("many"); }),
             Contains("the attribute 'many': it holds 1000 numbers"));
  CHECK_THAT(complaint<FileError>([&] { file.integer("fraction"); }),
             Contains("the attribute 'fraction': it does not hold whole numbers"));
  CHECK(file.integer("one") == 1);
}

TEST_CASE("an array is written with one value for each place of its shape", "[io][hdf5]") {
  Scratch const scratch;
  io::Hdf5Writer file(scratch / "a.hdf5");
  std::vector<float> const values(11);
  CHECK_THAT(complaint<FileError>([&] {
               file.write<float>("a", {3, 4}, values);
             }),
             Contains("the array 'a': 11 values given for a shape of 3 x 4"));
  CHECK_THAT(complaint<FileError>([&] {
               file.write<float>("a", {hsize_t{1} << 63, 2}, {});  // a product of 2^64
             }),
             Contains("0 values given"));
}
#endif
