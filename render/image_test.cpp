// SPDX-License-Identifier: Apache-2.0
#include "render/image.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace fasttree::render {
namespace {

namespace fs = std::filesystem;

class ImageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("fasttree_image_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override {
    std::error_code ignored;
    fs::permissions(folder_, fs::perms::owner_all, ignored);
    fs::remove_all(folder_, ignored);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

Image make_image(std::uint32_t width, std::uint32_t height, bool noise) {
  Image image{width, height, {}};
  std::mt19937 random(width * 31 + height);
  for (std::size_t i = 0; i < std::size_t{3} * width * height; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(noise ? random() : i / 97));
  return image;
}

Image read_png(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels =
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                            static_cast<int>(bytes.size()), &width, &height, &channels, 0);
  Image image;
  if (pixels == nullptr) return image;
  EXPECT_EQ(channels, 3);
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.rgb.assign(pixels, pixels + std::size_t{3} * image.width * image.height);
  stbi_image_free(pixels);
  return image;
}

TEST_F(ImageTest, ReadsBackWhatItWrote) {
  for (const auto& [width, height] :
       {std::pair{1u, 1u}, {2u, 1u}, {1u, 7u}, {33u, 17u}, {640u, 480u}}) {
    for (const bool noise : {false, true}) {
      const Image image = make_image(width, height, noise);
      const fs::path path = folder_ / "a.png";
      const Status status = write_png(image, path);
      ASSERT_TRUE(status.ok()) << status.message();
      EXPECT_EQ(read_png(path), image) << width << " x " << height;
    }
  }
  EXPECT_EQ(files(), 1u) << "temporary files left behind";
}

TEST_F(ImageTest, EncodesInMemoryWhatItWrites) {
  const Image image = make_image(33, 17, true);
  const fs::path path = folder_ / "a.png";
  ASSERT_TRUE(write_png(image, path).ok());
  const auto bytes = encode_png(image);
  ASSERT_TRUE(bytes.ok());
  std::ifstream file(path, std::ios::binary);
  const std::string written((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
  EXPECT_EQ(written,
            std::string(reinterpret_cast<const char*>(bytes.value().data()), bytes.value().size()));
  EXPECT_EQ(encode_png(Image{3, 3, {}}).status().code(), StatusCode::invalid_argument);
}

TEST_F(ImageTest, ReplacesWholeFilesOnly) {
  const fs::path path = folder_ / "a.png";
  ASSERT_TRUE(write_png(make_image(64, 64, true), path).ok());
  const Image small = make_image(3, 3, false);
  ASSERT_TRUE(write_png(small, path).ok());
  EXPECT_EQ(read_png(path), small);

  // A write that is refused leaves the old picture.
  EXPECT_EQ(write_png(Image{3, 3, {}}, path).code(), StatusCode::invalid_argument);
  EXPECT_EQ(read_png(path), small);
  EXPECT_EQ(files(), 1u);
}

TEST_F(ImageTest, RefusesImpossibleImages) {
  const std::string path = folder_ / "a.png";
  EXPECT_EQ(write_png(Image{}, path).code(), StatusCode::invalid_argument);
  EXPECT_EQ(write_png(Image{1, 1, {1, 2}}, path).code(), StatusCode::invalid_argument);
  EXPECT_EQ(write_png(Image{0xffffffffu, 0xffffffffu, {}}, path).code(),
            StatusCode::invalid_argument);
  EXPECT_EQ(files(), 0u);
}

TEST_F(ImageTest, SaysWhyItCannotWrite) {
  const Image image = make_image(8, 8, true);
  const Status missing = write_png(image, folder_ / "no" / "such" / "a.png");
  EXPECT_EQ(missing.code(), StatusCode::io_error);
  EXPECT_NE(missing.message().find("a.png"), std::string::npos);
  EXPECT_EQ(write_png(image, folder_).code(), StatusCode::io_error) << "a folder";
  EXPECT_EQ(write_png(image, "").code(), StatusCode::io_error);
  EXPECT_EQ(files(), 0u);
}

// A child process that may not write more than 100 bytes stands for a full disk.
TEST_F(ImageTest, FullDisk) {
  const fs::path path = folder_ / "a.png";
  const Image old = make_image(2, 2, false);
  ASSERT_TRUE(write_png(old, path).ok());
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100, 100};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const Status status = write_png(make_image(64, 64, true), path);
    ::_exit(status.code() == StatusCode::resource_limit ? 0 : 1);
  }
  int result = -1;
  ASSERT_EQ(::waitpid(child, &result, 0), child);
  EXPECT_TRUE(WIFEXITED(result) && WEXITSTATUS(result) == 0);
  EXPECT_EQ(read_png(path), old) << "the old picture has to stay";
  EXPECT_EQ(files(), 1u) << "temporary files left behind";
}

TEST_F(ImageTest, DevicesAreNotReplaced) {
  EXPECT_EQ(write_png(make_image(8, 8, true), "/dev/null").code(), StatusCode::io_error);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace fasttree::render
