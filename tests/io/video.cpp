#include <cstdlib>

#include <mpmpbd/io/video.hpp>

#include "../catch.hpp"
#include "scratch.hpp"

using namespace mpmpbd::io;
using Catch::Matchers::Contains;
using mpmpbd::render::Image;

namespace {

// A picture in which every byte tells its place and its frame.
Image frame(int number, int width = 6, int height = 4) {
  Image image(width, height);
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    image.rgb[i] = std::uint8_t(31 * i + 101 * std::size_t(number));
  return image;
}

// A program that stands in for ffmpeg.
Path script(Scratch const& scratch, std::string const& body) {
  Path path = scratch / "encoder.sh";
  write_file(path, "#!/bin/sh\n" + body + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

}  // namespace

#if MPMPBD_HAS_PNG
TEST_CASE("a PNG file says its size and is whole", "[io][png]") {
  Scratch const scratch;
  write_png(scratch / "picture.png", frame(1, 300, 20));
  std::string const bytes = read_file(scratch / "picture.png");
  CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(bytes.substr(16, 8) == std::string("\0\0\x01\x2c\0\0\0\x14", 8));  // 300 x 20, big endian
  CHECK_THAT(bytes.substr(bytes.size() - 8), Contains("IEND"));
  CHECK(scratch.files() == 1);
}

TEST_CASE("a PNG file of an empty image is refused", "[io][png]") {
  Scratch const scratch;
  CHECK_THAT(complaint<FileError>([&] { write_png(scratch / "p.png", Image{}); }),
             Contains("0 x 0 pixels"));
}

TEST_CASE("without ffmpeg a video becomes numbered pictures and says so", "[io][video]") {
  Scratch const scratch;
  Video video(scratch / "stitch.mp4", 6, 4, 25.0, "no-such-encoder");
  for (int k = 0; k < 3; ++k) video.add(frame(k));
  std::string const said = video.finish();
  CHECK_THAT(said, Contains("no-such-encoder is not on the PATH: wrote 3 frames"));
  CHECK(std::filesystem::exists(scratch / "stitch_frames/frame_000002.png"));
  CHECK_FALSE(std::filesystem::exists(scratch / "stitch.mp4"));
}

TEST_CASE("pictures of an earlier, longer video do not stay among the new ones", "[io][video]") {
  Scratch const scratch;
  for (int frames : {3, 1}) {
    Video video(scratch / "stitch.mp4", 6, 4, 25.0, "no-such-encoder");
    for (int k = 0; k < frames; ++k) video.add(frame(k));
    video.finish();
  }
  CHECK(std::filesystem::exists(scratch / "stitch_frames/frame_000000.png"));
  CHECK_FALSE(std::filesystem::exists(scratch / "stitch_frames/frame_000001.png"));
}
#endif

TEST_CASE("the encoder gets every byte of every frame in order", "[io][video]") {
  Scratch const scratch;
  // The last argument is the file to write.
  Path const encoder = script(scratch, "for last; do :; done; exec cat > \"${last#file:}\"");
  Path const path = scratch / "a video's name.mp4";
  std::string expected;
  Video video(path, 64, 48, 25.0, encoder.string());
  for (int k = 0; k < 40; ++k) {
    Image const image = frame(k, 64, 48);
    expected.append(image.rgb.begin(), image.rgb.end());
    video.add(image);
  }
  CHECK_FALSE(std::filesystem::exists(path));
  CHECK_THAT(video.finish(), Contains("wrote 40 frames"));
  CHECK(read_file(path) == expected);
}

TEST_CASE("the encoder is told a file, whatever colons its name has", "[io][video]") {
  Scratch const scratch;
  Path const encoder =
      script(scratch, R"(for last; do :; done; cat > /dev/null; echo "$last" > "${last#file:}")");
  Path const path = scratch / "10:30.mp4";
  Video video(path, 6, 4, 25.0, encoder.string());
  video.add(frame(0));
  video.finish();
  CHECK(read_file(path) == "file:" + path.string() + ".part\n");
}

TEST_CASE("a video without frames leaves the one before as it was", "[io][video]") {
  Scratch const scratch;
  Path const encoder = script(scratch, "for last; do :; done; exec cat > \"${last#file:}\"");
  Path const path = scratch / "stitch.mp4";
  write_file(path, "an older video");
  {
    Video video(path, 6, 4, 25.0, encoder.string());
    CHECK_THAT(video.finish(), Contains("it was given no frame"));
  }
  CHECK(read_file(path) == "an older video");
  CHECK(scratch.files() == 2);  // it and the script
}

TEST_CASE("an encoder that fails is reported with its own words and leaves no video",
          "[io][video]") {
  Scratch const scratch;
  Path const encoder = script(scratch, "echo 'Unknown encoder libx264' >&2; exit 1");
  Path const path = scratch / "stitch.mp4";
  std::string const said = complaint<FileError>([&] {
    Video video(path, 64, 48, 25.0, encoder.string());
    for (int k = 0; k < 100; ++k) video.add(frame(k, 64, 48));
    video.finish();
  });
  CHECK_THAT(said, Contains(path.string()));
  CHECK_THAT(said, Contains("Unknown encoder libx264"));
  CHECK(scratch.files() == 1);  // the script
}

TEST_CASE("a frame of another size is refused with both sizes", "[io][video]") {
  Scratch const scratch;
  Path const encoder = script(scratch, "exec cat > /dev/null");
  Video video(scratch / "stitch.mp4", 6, 4, 25.0, encoder.string());
  CHECK_THAT(complaint<FileError>([&] { video.add(frame(0, 8, 4)); }),
             Contains("8 x 4 pixels, the video 6 x 4"));
}

TEST_CASE("ffmpeg, where present, writes an mp4 of odd size too", "[io][video]") {
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) {
    WARN("ffmpeg is not on the PATH: not tested here");
    return;
  }
  Scratch const scratch;
  Video video(scratch / "odd.mp4", 251, 125, 25.0);
  for (int k = 0; k < 10; ++k) video.add(frame(k, 251, 125));
  CHECK_THAT(video.finish(), Contains("wrote 10 frames"));
  CHECK_THAT(read_file(scratch / "odd.mp4").substr(0, 64), Contains("ftyp"));
}
