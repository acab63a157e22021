// Films are made by ffmpeg, here by scripts of that name that do what it does when all is well, and when not.
#include "apps/picture_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "apps/interrupt.h"
#include "core/error.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

class PictureFolder : public ::testing::Test {
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
  // Of the shell; $film is what ffmpeg is to write.
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

TEST_F(PictureFolder, AFilmTakesThePlaceOfTheLast) {
  ffmpegDoes("echo \"$@\" > \"$film\"");
  makeMovie(folder_, 12, 24, movie_);
  EXPECT_NE(movie().find("-framerate 24"), std::string::npos) << movie();
  EXPECT_NE(movie().find("-frames:v 12"), std::string::npos) << movie();
  EXPECT_EQ(films(), 1u);
}

TEST_F(PictureFolder, AFilmIsMadeOfOddPicturesInAnyFolder) {
  ffmpegDoes("printf '%s\\n' \"$@\" > \"$film\"");
  makeMovie(folder_ / "50%d", 12, 24, movie_);
  EXPECT_NE(movie().find("/50%%d/frame_%04d.png\n"), std::string::npos) << "only the last is a pattern";
  EXPECT_NE(movie().find("-vf\npad=ceil(iw/2)*2:ceil(ih/2)*2\n"), std::string::npos) << movie();
}

TEST_F(PictureFolder, AFilmThatFailsLeavesTheLast) {
  ffmpegDoes("echo half > \"$film\"; exit 1");
  EXPECT_THROW(makeMovie(folder_, 12, 24, movie_), Error);
  EXPECT_EQ(movie(), "the last film");
  EXPECT_EQ(films(), 1u);
  setenv("PATH", "/nowhere", 1);
  EXPECT_THROW(makeMovie(folder_, 12, 24, movie_), Error) << "there is no ffmpeg";
}

TEST_F(PictureFolder, AnInterruptEndsFfmpeg) {
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

TEST_F(PictureFolder, WhatWasDrawnBeforeAnInterruptIsFilmed) {
  ffmpegDoes("sleep 0.1; echo whole > \"$film\"");
  g_interrupted = true;
  makeMovie(folder_, 12, 24, movie_);
  EXPECT_EQ(movie(), "whole\n");
}

}  // namespace
}  // namespace strandcast
