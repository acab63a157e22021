// Films are made by scripts named ffmpeg that imitate its success and its failures.
#include "options/output_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "core/error.h"
#include "options/console.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

class PictureFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    path_ = std::getenv("PATH");
    setenv("PATH", (folder_.string() + ":" + path_).c_str(), 1);
    std::ofstream(movie_) << "the last film";
  }
  void TearDown() override {
    setenv("PATH", path_.c_str(), 1);
    g_interrupted = false;
    fs::remove_all(folder_);
  }
  // Installs a shell script as ffmpeg; $film is the output file.
  void ffmpegDoes(const std::string& commands) {
    std::ofstream(folder_ / "ffmpeg") << "#!/bin/sh\nfor film; do :; done\n" << commands << "\n";
    fs::permissions(folder_ / "ffmpeg", fs::perms::owner_all);
  }
  std::string movie() const {
    std::ifstream in(movie_);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  size_t films() const {
    size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) count += entry.path().extension() == ".mp4";
    return count;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("picture_folder_" + std::to_string(getpid()));
  const fs::path movie_ = folder_ / "film.mp4";
  std::string path_;
};

TEST_F(PictureFolderTest, AFilmTakesThePlaceOfTheLast) {
  ffmpegDoes("echo \"$@\" > \"$film\"");
  makeMovie(folder_, 12, 24, movie_);
  EXPECT_NE(movie().find("-framerate 24"), std::string::npos) << movie();
  EXPECT_NE(movie().find("-frames:v 12"), std::string::npos) << movie();
  EXPECT_EQ(films(), 1u);
}

TEST_F(PictureFolderTest, AFilmIsMadeOfOddPicturesInAnyFolder) {
  ffmpegDoes("printf '%s\\n' \"$@\" > \"$film\"");
  makeMovie(folder_ / "50%d", 12, 24, movie_);
  EXPECT_NE(movie().find("/50%%d/frame_%04d.png\n"), std::string::npos) << "only the last is a pattern";
  EXPECT_NE(movie().find("-vf\npad=ceil(iw/2)*2:ceil(ih/2)*2\n"), std::string::npos) << movie();
}

TEST_F(PictureFolderTest, AFilmThatFailsLeavesTheLast) {
  ffmpegDoes("echo half > \"$film\"; exit 1");
  EXPECT_THROW(makeMovie(folder_, 12, 24, movie_), Error);
  EXPECT_EQ(movie(), "the last film");
  EXPECT_EQ(films(), 1u);
  setenv("PATH", "/nowhere", 1);
  EXPECT_THROW(makeMovie(folder_, 12, 24, movie_), Error) << "there is no ffmpeg";
}

TEST_F(PictureFolderTest, AFilmIsTriedBeforeAnythingIsDrawn) {
  ffmpegDoes("echo small > \"$film\"");
  EXPECT_EQ(errorOf([&] { checkMovie(movie_); }), "");
  EXPECT_EQ(movie(), "the last film") << "it is as it was";
  EXPECT_EQ(films(), 1u);
  EXPECT_NE(errorOf([&] { checkMovie(folder_ / "absent" / "film.mp4"); }).find("absent"), std::string::npos);
  EXPECT_NE(errorOf([&] { checkMovie(folder_ / "film"); }).find("has no extension"), std::string::npos);
  EXPECT_NE(errorOf([&] { checkMovie(""); }).find("has no name"), std::string::npos);
  ffmpegDoes("exit 1");
  EXPECT_EQ(errorOf([&] { checkMovie("film.xyz"); }),
            "ffmpeg does not write this format: --movie film.xyz; choose another extension, e.g. .mp4");
  setenv("PATH", "/nowhere", 1);
  EXPECT_EQ(errorOf([&] { checkMovie(movie_); }),
            "ffmpeg is not installed: --movie " + movie_.string() + "; install it, or leave out --movie");
}

TEST_F(PictureFolderTest, NewPicturesDoNotLieBesideEarlierOnes) {
  const fs::path out = folder_ / "out";
  fs::create_directories(out / "frame_0007.png");  // a folder of that name is not a picture
  for (const char* name :
       {"frame_0000.png", "frame_0002.png", "frame_12345.png", "frame_002.png", "frame_00002.png",
        "frame_0002.png.txt", "my_frame_0002.png", "Frame_0002.png", "frame_0002.jpg"})
    std::ofstream(out / name) << "earlier";
  fs::create_symlink(out / "frame_0002.jpg", out / "frame_0009.png");
  Image picture;
  picture.width = picture.height = 1;
  picture.rgb = {1, 2, 3};
  PictureFolder pictures(out);
  EXPECT_TRUE(fs::exists(out / "frame_0002.png")) << "until there is a new one";
  pictures.write(picture);
  pictures.write(picture);
  EXPECT_EQ(pictures.written(), 2);
  for (const char* gone : {"frame_0002.png", "frame_12345.png"}) EXPECT_FALSE(fs::exists(out / gone)) << gone;
  for (const char* kept :
       {"frame_0000.png", "frame_0001.png", "frame_0007.png", "frame_0009.png", "frame_002.png",
        "frame_00002.png", "frame_0002.png.txt", "my_frame_0002.png", "Frame_0002.png", "frame_0002.jpg"})
    EXPECT_TRUE(fs::exists(out / kept)) << kept;
}

TEST_F(PictureFolderTest, AnInterruptEndsFfmpeg) {
  ffmpegDoes("echo half > \"$film\"; exec sleep 60");
  std::thread interrupter([&] {
    while (films() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    g_interrupted = true;
  });
  const auto start = std::chrono::steady_clock::now();
  makeMovie(folder_, 12, 24, movie_);
  interrupter.join();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  EXPECT_EQ(movie(), "the last film");
  EXPECT_EQ(films(), 1u);
}

TEST_F(PictureFolderTest, WhatWasDrawnBeforeAnInterruptIsFilmed) {
  ffmpegDoes("sleep 0.1; echo whole > \"$film\"");
  g_interrupted = true;
  makeMovie(folder_, 12, 24, movie_);
  EXPECT_EQ(movie(), "whole\n");
}

}  // namespace
}  // namespace strandcast
