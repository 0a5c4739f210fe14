#include <csignal>

#include <sys/resource.h>

#include <mpmpbd/io/file.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

using namespace mpmpbd::io;
using Catch::Matchers::Contains;

TEST_CASE("a file appears only when it is whole", "[io][file]") {
  Scratch const scratch;
  Path const path = scratch / "whole.txt";
  OutputFile file(path);
  file.write("first half, ");
  file.flush();
  CHECK_FALSE(std::filesystem::exists(path));
  file.write("second half");
  file.commit();
  CHECK(read_file(path) == "first half, second half");
  CHECK(scratch.files() == 1);
}

TEST_CASE("an exception while writing leaves the old file as it was", "[io][file]") {
  Scratch const scratch;
  Path const path = scratch / "kept.txt";
  write_file(path, "old");
  try {
    OutputFile file(path);
    file.write("new, but not");
    throw std::runtime_error("the run stops here");
  } catch (std::runtime_error const&) {}
  CHECK(read_file(path) == "old");
  CHECK(scratch.files() == 1);
}

TEST_CASE("a folder that does not exist is refused with path, reason and advice", "[io][file]") {
  Scratch const scratch;
  Path const path = scratch / "no/such/folder.txt";
  std::string const said = complaint<FileError>([&] { write_file(path, "text"); });
  CHECK_THAT(said, Contains(path.string()));
  CHECK_THAT(said, Contains("No such file or directory"));
  CHECK_THAT(said, Contains("create it"));
}

TEST_CASE("a missing file is refused with its path", "[io][file]") {
  Scratch const scratch;
  Path const path = scratch / "missing.txt";
  CHECK_THAT(complaint<FileError>([&] { read_file(path); }), Contains(path.string()));
  CHECK_THAT(complaint<FileError>([&] { read_file(scratch.folder); }),
             Contains(scratch.folder.string()));
}

TEST_CASE("a disk that takes only a part of a file is reported with the path and keeps nothing",
          "[io][file]") {
  Scratch const scratch;
  Path const path = scratch / "too_large.bin";
  // A limit on the size of files stands in for the end of the disk.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 10000;
  auto const handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  std::string const said = complaint<FileError>([&] { write_file(path, std::string(50000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK_THAT(said, Contains(path.string()));
  CHECK_THAT(said, Contains("free some space"));
  CHECK(scratch.files() == 0);
}
