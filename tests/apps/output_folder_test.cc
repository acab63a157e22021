#include "options/output_folder.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, StaysWhereItWasOrWhereSomethingIsInIt) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "a" / "b";
  {
    const OutputFolder unused(folder);
    EXPECT_TRUE(fs::is_directory(folder));
  }
  EXPECT_FALSE(fs::exists(scratch / "a"));
  fs::create_directory(scratch / "a");
  { const OutputFolder unused(folder / ""); }
  EXPECT_FALSE(fs::exists(folder));
  EXPECT_TRUE(fs::exists(scratch / "a")) << "it was there";
  {
    const OutputFolder used(folder);
    std::ofstream(folder / "picture") << "one";
  }
  EXPECT_TRUE(fs::exists(folder / "picture"));
  { const OutputFolder old(folder); }
  EXPECT_TRUE(fs::exists(folder / "picture"));
}

TEST(OutputFolder, OneThatCannotBeMadeIsSaid) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "file") << "";
  const fs::path folder = scratch / "file" / "folder";
  EXPECT_NE(errorOf([&] { OutputFolder{folder}; }).find("the folder cannot be made: " + folder.string()),
            std::string::npos);
}

}  // namespace
}  // namespace strandcast
