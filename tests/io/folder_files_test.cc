// Reads confined to a folder, through links of every kind.
#include "io/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "io/mesh_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

class FilesBeneath : public ::testing::Test {
 protected:
  FilesBeneath() {
    fs::create_directories(open_ / "more" / "deep");
    fs::create_directories(scratch_ / "open too");
    write(open_ / "a b.txt", "a");
    write(open_ / "more" / "c..txt", "c");
    write(scratch_ / "secret.txt", "secret");
    write(scratch_ / "open too" / "d.txt", "secret");
  }
  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
  std::string read(const std::string& name) const {
    const std::vector<std::byte> bytes = readBeneath(open_, name);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  void link(const fs::path& to, const std::string& name) const { fs::create_symlink(to, open_ / name); }
  void expectRefused(const std::string& name, const std::string& words) const {
    expectError([&] { read(name); }, {words});
    expectError([&] { checkBeneath(open_, name, "the folder", "a command"); }, {words, "a command"});
    try {
      read(name);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find(scratch_.path().string()), std::string::npos)
          << "tells where the folder is: " << error.what();
    }
  }

  const ScratchFolder scratch_;
  const fs::path open_ = scratch_ / "open";
};

TEST_F(FilesBeneath, AreReadByNameAndThroughLinksThatStayThere) {
  link("a b.txt", "file link");
  link("file link", "link to a link");
  link("more", "folder link");
  link("../../more/./deep/../c..txt", "more/deep/up and down");
  link("..", "more/up");
  fs::create_directory_symlink("open", scratch_ / "link to open");
  fs::create_hard_link(scratch_ / "secret.txt", open_ / "hard link");
  EXPECT_EQ(read("a b.txt"), "a");
  EXPECT_EQ(read("./more//c..txt"), "c");
  EXPECT_EQ(read("file link"), "a");
  EXPECT_EQ(read("link to a link"), "a");
  EXPECT_EQ(read("folder link/c..txt"), "c");
  EXPECT_EQ(read("more/deep/up and down"), "c");
  EXPECT_EQ(read("more/up/a b.txt"), "a");
  EXPECT_EQ(read("hard link"), "secret") << "it is a file of the folder";
  EXPECT_EQ(readBeneath(scratch_ / "link to open", "a b.txt").size(), 1u) << "the folder itself may be one";
}

TEST_F(FilesBeneath, AreNotReachedThroughLinksThatLeadOut) {
  link(scratch_ / "secret.txt", "absolute");
  link(open_ / "a b.txt", "absolute and back");
  link("../secret.txt", "relative");
  link("..", "up");
  link("more/../../open/a b.txt", "out and back");
  link("../open too", "sibling");
  link("relative", "link to a link");
  link("more", "folder link");
  link("../../secret.txt", "more/deeper");
  link("/proc/self/cwd", "magic");
  for (const char* name : {"absolute", "absolute and back", "relative", "up", "up/secret.txt",
                           "up/open/a b.txt", "out and back", "sibling/d.txt", "link to a link",
                           "folder link/deeper", "more/deeper", "magic/x", "absolute/x", "up/absent.txt"})
    expectRefused(name, "is a link out of");
}

TEST_F(FilesBeneath, AreNotReachedByNamesThatLeadOut) {
  for (const std::string& name :
       {std::string(), (open_ / "a b.txt").string(), std::string("/etc/passwd"), std::string("../secret.txt"),
        std::string("more/../a b.txt"), std::string("more/../../secret.txt"), std::string("a b.txt\0x", 9)})
    expectError([&] { read(name); }, {"is no name within"});
  expectError([&] { readBeneath(scratch_ / "gone", "a b.txt"); }, {"cannot be read"});
}

TEST_F(FilesBeneath, ThatAreNoFilesAreRefusedAndNotWaitedFor) {
  link("loop", "loop");
  link("nowhere", "dangling");
  ASSERT_EQ(::mkfifo((open_ / "pipe").c_str(), 0600), 0);
  expectRefused("loop", "is not in");
  expectRefused("dangling", "is not in");
  expectRefused("absent.txt", "is not in");
  expectRefused("a b.txt/x", "is not in");
  expectRefused("more", "is not a regular file");
  expectRefused("pipe", "is not a regular file");
  expectRefused("more/.", "is a folder");
  write(open_ / "empty", "");
  expectError([&] { read("empty"); }, {"the file is empty"});
}

TEST_F(FilesBeneath, HoldTheBuffersOfAGltfToo) {
  const samples::Bytes glb = samples::glb(), whole = samples::gltf();
  const std::string text(reinterpret_cast<const char*>(whole.data()), whole.size());
  const auto gltf = [&](const std::string& name, const std::string& uri) {
    writeFileBytes(open_ / name, samples::fromText(text.substr(0, text.find("data:")) + uri + "\"}]}"));
  };
  const auto load = [&](const std::string& name) { return loadMesh(name, {}, kSkippedGroups, open_).mesh; };
  writeFileBytes(open_ / "more" / "in.bin", std::span(glb).last(60));
  writeFileBytes(scratch_ / "out.bin", std::span(glb).last(60));
  link("in.bin", "more/link.bin");
  link("../../out.bin", "more/out.bin");
  link(scratch_ / "out.bin", "more/absolute.bin");
  link("../..", "more/up");
  link("more/quad.gltf", "quad.gltf");
  fs::create_hard_link(scratch_ / "out.bin", open_ / "more" / "hard.bin");
  for (const char* uri : {"in.bin", "./in.bin", "link.bin", "hard.bin", "%69n.bin"}) {
    gltf("more/quad.gltf", uri);
    EXPECT_EQ(load("more/quad.gltf").positions.size(), 8u) << uri;
  }
  for (const char* uri : {"out.bin", "absolute.bin", "up/out.bin", "%6Fut.bin", "up/open/more/in.bin"}) {
    gltf("more/quad.gltf", uri);
    expectError([&] { load("more/quad.gltf"); }, {"is a link out of its folder"});
  }
  for (const char* uri : {"../in.bin", "%2e%2e/out.bin", "..%2Fout.bin", "/etc/passwd",
                          "deep/../../../out.bin", "%2Fetc%2Fpasswd", "file:///etc/passwd", "in.bin%00"}) {
    gltf("more/quad.gltf", uri);
    expectError([&] { load("more/quad.gltf"); }, {"not read from here", "more/quad.gltf, buffers[0]"});
  }
  gltf("more/quad.gltf", "in.bin");
  // The buffer is not in the folder of the link.
  expectError([&] { load("quad.gltf"); }, {"'in.bin' is not in"});
  link("more/in.bin", "in.bin");
  EXPECT_EQ(load("quad.gltf").positions.size(), 8u);
}

}  // namespace
}  // namespace strandcast
