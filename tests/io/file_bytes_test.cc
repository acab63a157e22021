#include "io/file_bytes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "tests/full_disk.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;
using samples::Bytes;

size_t filesIn(const ScratchFolder& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder.path()), {}));
}

TEST(TextOfFile, HasNoByteOrderMark) {
  const auto text = [](const std::string& bytes) {
    return std::string(textOfFile(std::as_bytes(std::span(bytes.data(), bytes.size()))));
  };
  EXPECT_EQ(text("\xef\xbb\xbfv 0"), "v 0");
  EXPECT_EQ(text("v \xef\xbb\xbf"), "v \xef\xbb\xbf");
  EXPECT_EQ(text("\xef\xbb"), "\xef\xbb");
  EXPECT_EQ(text(""), "");
}

TEST(WriteFileBytes, TakesThePlaceOfTheOldFileAndKeepsItsPermissions) {
  const ScratchFolder folder;
  const fs::path file = folder / "a";
  writeFileBytes(file, samples::fromText("old and long"));
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  writeFileBytes(file, samples::fromText("new"));
  EXPECT_EQ(readFileBytes(file), samples::fromText("new"));
  EXPECT_EQ(fs::status(file).permissions(),
            fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  EXPECT_EQ(filesIn(folder), 1u);
}

TEST(WriteFileBytes, AFullDiskLeavesTheOldFileAndNothingBesideIt) {
  const ScratchFolder folder;
  const fs::path file = folder / "a";
  writeFileBytes(file, samples::fromText("old"));
  {
    const FullDisk disk(1000);
    EXPECT_THROW(writeFileBytes(file, Bytes(100000)), Error);
    EXPECT_THROW(writeFileBytes(folder / "b", Bytes(100000)), Error);
  }
  EXPECT_EQ(readFileBytes(file), samples::fromText("old"));
  EXPECT_EQ(filesIn(folder), 1u);
  EXPECT_THROW(writeFileBytes("/dev/full", samples::fromText("new")), Error);
}

TEST(WriteFileBytes, LinksAndPipesAreWrittenThrough) {
  const ScratchFolder folder;
  writeFileBytes(folder / "a", samples::fromText("old"));
  fs::create_symlink("a", folder / "link");
  fs::create_symlink("b", folder / "ahead");
  writeFileBytes(folder / "link", samples::fromText("new"));
  writeFileBytes(folder / "ahead", samples::fromText("first"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(readFileBytes(folder / "a"), samples::fromText("new"));
  EXPECT_EQ(readFileBytes(folder / "b"), samples::fromText("first"));
  EXPECT_EQ(filesIn(folder), 4u);
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  writeFileBytes("/dev/fd/" + std::to_string(ends[1]), samples::fromText("new"));
  char got[3] = {};
  EXPECT_EQ(read(ends[0], got, 3), 3);
  EXPECT_EQ(std::string(got, 3), "new");
  close(ends[0]);
  close(ends[1]);
}

TEST(WriteFileBytes, WhatCannotBeWrittenIsAnError) {
  const ScratchFolder folder;
  EXPECT_THROW(writeFileBytes(folder.path(), samples::fromText("new")), Error);
  EXPECT_THROW(writeFileBytes(folder / "absent" / "a", samples::fromText("new")), Error);
}

}  // namespace
}  // namespace strandcast
