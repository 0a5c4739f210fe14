// Videos: frames go through a socket to ffmpeg where it is on the PATH; otherwise they become numbered
// PNG files, and finish() says so.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <mpmpbd/io/png.hpp>

namespace mpmpbd::io {

namespace detail {

// A program that reads its standard input from us.
class Encoder {
 public:
  // `log` takes what the program has to say.
  Encoder(std::vector<std::string> const& command, Path const& log) {
    std::vector<char*> arguments;
    arguments.reserve(command.size() + 1);
    for (std::string const& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    // A socket and not a pipe: sending to a program that has died is an error here, not a signal.
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    bool const started =
        posix_spawnp(&process_, arguments[0], &actions, nullptr, arguments.data(), environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (started)
      socket_ = ends[0];
    else
      ::close(ends[0]);
  }
  ~Encoder() { close(); }
  Encoder(Encoder const&) = delete;
  Encoder& operator=(Encoder const&) = delete;

  bool running() const { return socket_ >= 0; }

  bool send(void const* data, std::size_t bytes) const {
    auto const* from = static_cast<char const*>(data);
    while (bytes > 0) {
      ssize_t const sent = ::send(socket_, from, bytes, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) return false;
      from += sent;
      bytes -= std::size_t(sent);
    }
    return true;
  }

  // Ends the input and waits for the program; true when it was content.
  bool close() {
    if (socket_ < 0) return false;
    ::close(socket_);
    socket_ = -1;
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {}
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

 private:
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace detail

class Video {
 public:
  // An mp4 (H.264, yuv420p: plays everywhere) of width x height pixels.
  Video(Path path, int width, int height, double frames_per_second,
        std::string const& program = "ffmpeg")
      : path_(std::move(path)),
        part_(path_.string() + ".part"),
        log_(path_.string() + ".log"),
        width_(width),
        height_(height),
        rate_(frames_per_second),
        program_(program),
        writable_(path_),
        encoder_(command(), log_) {
    if (!encoder_.running()) start_frames();
  }
  // Without finish() there is no video.
  ~Video() {
    encoder_.close();
    std::error_code ignored;
    std::filesystem::remove(log_, ignored);
  }
  Video(Video const&) = delete;
  Video& operator=(Video const&) = delete;

  void add(render::Image const& image) {
    if (image.width != width_ || image.height != height_)
      throw FileError(
          fmt::format("cannot add to '{}': the frame has {} x {} pixels, the video {} x {}",
                      path_.string(), image.width, image.height, width_, height_));
    if (!encoder_.running())
      write_png(frames_ / fmt::format("frame_{:06}.png", count_), image);
    else if (!encoder_.send(image.rgb.data(), image.rgb.size()))
      fail();
    ++count_;
  }

  // Completes the video and tells in one sentence what was written; without a frame, what was there before stays.
  std::string finish() {
    if (count_ == 0) return fmt::format("no video '{}': it was given no frame", path_.string());
    if (!encoder_.running())
      return fmt::format(
          "{} is not on the PATH: wrote {} frames to '{}'; install it and join them with: ffmpeg -framerate {} -i '{}' -pix_fmt yuv420p '{}'",
          program_, count_, frames_.string(), rate_, (frames_ / "frame_%06d.png").string(),
          path_.string());
    if (!encoder_.close()) fail();
    writable_.commit();
    return fmt::format("wrote {} frames to '{}'", count_, path_.string());
  }

 private:
  std::vector<std::string> command() const {
    std::vector<std::string> words = {program_, "-y",       "-loglevel", "error",
                                      "-f",     "rawvideo", "-pix_fmt",  "rgb24"};
    words.insert(words.end(),
                 {"-s", fmt::format("{}x{}", width_, height_), "-r", fmt::format("{}", rate_)});
    words.insert(words.end(),
                 {"-i", "pipe:0", "-an", "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"});
    // The format halves the resolution of colours: odd sizes get one more line.
    if (width_ % 2 != 0 || height_ % 2 != 0)
      words.insert(words.end(), {"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"});
    // What comes before a colon in a name would be taken for a protocol.
    words.insert(words.end(), {"-movflags", "+faststart", "-f", "mp4", "file:" + part_.string()});
    return words;
  }

  void start_frames() {
    frames_ = path_.parent_path() / (path_.stem().string() + "_frames");
    std::error_code error;
    std::filesystem::create_directories(frames_, error);
    if (error) throw detail::cannot("write", frames_, error.value());
    // Frames of a longer run before this one would be taken for ours.
    for (int k = 0; std::filesystem::remove(frames_ / fmt::format("frame_{:06}.png", k), error);
         ++k) {}
  }

  [[noreturn]] void fail() {
    encoder_.close();
    throw FileError(fmt::format("cannot write '{}': {} stopped after {} frames: {}", path_.string(),
                                program_, count_, read_file(log_)));
  }

  Path path_;
  Path part_;
  Path log_;
  int width_;
  int height_;
  double rate_;
  std::string program_;
  OutputFile
      writable_;  // proves before the first frame that the place can be written, and names the result
  detail::Encoder encoder_;
  Path frames_{};
  int count_ = 0;
};

}  // namespace mpmpbd::io
