// Files that are either whole or not there.
//
// Everything is written under the name `<path>.part`, which takes its real name only after the last
// byte is on the way to the disk. A run that is killed leaves a .part, never a file that looks whole.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace mpmpbd::io {

using Path = std::filesystem::path;

// A file that cannot be read or written, with its path, the reason, and what to do.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {

inline FileError cannot(std::string_view verb, Path const& path, int error) {
  std::string const folder =
      path.has_parent_path() ? path.parent_path().string() : std::string(".");
  std::string advice;
  if (error == ENOENT && !std::filesystem::exists(folder))
    advice =
        fmt::format("; the folder '{}' does not exist, create it or give another path", folder);
  if (error == EACCES)
    advice = fmt::format("; allow access to the folder '{}' or give another path", folder);
  if (error == ENOSPC || error == EFBIG) advice = "; free some space or give another path";
  FileError complaint(
      fmt::format("cannot {} '{}': {}{}", verb, path.string(), std::strerror(error), advice));
  return complaint;
}

}  // namespace detail

class OutputFile {
 public:
  explicit OutputFile(Path path) : path_(std::move(path)), part_(path_) {
    part_ += ".part";
    file_ = std::fopen(part_.c_str(), "wb");
    if (file_ == nullptr) throw detail::cannot("write", path_, errno);
  }
  // Without commit() there is no file: an exception on the way takes the part away with it.
  ~OutputFile() {
    if (file_ == nullptr) return;
    std::fclose(file_);
    std::remove(part_.c_str());
  }
  OutputFile(OutputFile const&) = delete;
  OutputFile& operator=(OutputFile const&) = delete;

  void write(void const* data, std::size_t bytes) {
    if (std::fwrite(data, 1, bytes, file_) != bytes) throw detail::cannot("write", path_, errno);
  }
  void write(std::string_view text) { write(text.data(), text.size()); }
  void flush() {
    if (std::fflush(file_) != 0) throw detail::cannot("write", path_, errno);
  }

  // Gives the file its name. A file of that name is replaced in one step.
  void commit() {
    flush();
    std::FILE* const file = file_;
    file_ = nullptr;
    int const closed = std::fclose(file) == 0 ? 0 : errno;
    if (closed == 0 && std::rename(part_.c_str(), path_.c_str()) == 0) return;
    int const error = closed != 0 ? closed : errno;
    std::remove(part_.c_str());
    throw detail::cannot("write", path_, error);
  }

  // Leaves what was written so far under the name of the part.
  void abandon() {
    if (file_ != nullptr) std::fclose(file_);
    file_ = nullptr;
  }

  Path const& path() const { return path_; }

 private:
  Path path_;
  Path part_;
  std::FILE* file_ = nullptr;
};

// Writes a whole file at once.
inline void write_file(Path const& path, std::string_view content) {
  OutputFile file(path);
  file.write(content);
  file.commit();
}

// The whole content of a file.
inline std::string read_file(Path const& path) {
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) throw detail::cannot("read", path, errno);
  std::string content;
  char buffer[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file)) > 0) content.append(buffer, count);
  int const error = std::ferror(file) ? (errno != 0 ? errno : EIO) : 0;
  std::fclose(file);
  if (error != 0) throw detail::cannot("read", path, error);  // for example a folder
  return content;
}

}  // namespace mpmpbd::io
