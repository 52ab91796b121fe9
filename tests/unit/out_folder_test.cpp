// Files that take their names once they are whole.
#include "core/out_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/full_disk.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(NewFolders, GoAgainWhereNothingCameToLieInThem) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path("there"));
  for (const char* name : {"there/a/b/", "there/a/b", "there"}) {
    const NewFolders made(folder.path(name));
    prepare_out_folder(folder.path(name), {}, false);
    EXPECT_TRUE(fs::is_directory(folder.path(name)));
  }
  EXPECT_FALSE(fs::exists(folder.path("there/a")));
  EXPECT_TRUE(fs::exists(folder.path("there")));
  {
    const NewFolders made(folder.path("there/a/b"));
    prepare_out_folder(folder.path("there/a/b"), {}, false);
    folder.write("there/a/c.txt", std::string("result"));
  }
  EXPECT_FALSE(fs::exists(folder.path("there/a/b")));
  EXPECT_EQ(folder.read("there/a/c.txt"), "result");
}

TEST(WholeFile, LeavesWhatWasThereUntilItIsKept) {
  const TemporaryFolder folder;
  folder.write("page.html", std::string("earlier"));
  {
    const WholeFile file(folder.path("page.html"));
    folder.write("page.html.part", std::string("half"));
    EXPECT_EQ(file.while_written(), folder.path("page.html.part"));
  }
  EXPECT_EQ(folder.read("page.html"), "earlier");
  EXPECT_FALSE(fs::exists(folder.path("page.html.part")));
  WholeFile file(folder.path("page.html"), ".html");
  folder.write("page.html.part.html", std::string("new"));
  file.keep();
  EXPECT_EQ(folder.read("page.html"), "new");
  EXPECT_FALSE(fs::exists(folder.path("page.html.part.html")));
}

TEST(WholeFile, FollowsLinksAndWritesToDevicesAsTheyAre) {
  const TemporaryFolder folder;
  folder.write("real.txt", std::string("earlier"));
  fs::create_symlink("real.txt", folder.path("link.txt"));
  write_text_file(folder.path("link.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(folder.path("link.txt")));
  EXPECT_EQ(folder.read("real.txt"), "new");
  write_text_file("/dev/null", "anything");
  EXPECT_FALSE(fs::exists("/dev/null.part"));
  EXPECT_THAT(input_error_of([] { write_text_file("/dev/full", "anything"); }), HasSubstr("No space left"));
}

TEST(WholeFile, OnAFullDiskTheEarlierOneStays) {
  const TemporaryFolder folder;
  folder.write("page.html", std::string("earlier"));
  {
    const FullDisk full(10);
    EXPECT_THAT(input_error_of([&] { write_text_file(folder.path("page.html"), std::string(1000, 'x')); }),
                HasSubstr("page.html: cannot be written (File too large)"));
  }
  EXPECT_EQ(folder.read("page.html"), "earlier");
  EXPECT_FALSE(fs::exists(folder.path("page.html.part")));
}

TEST(WholeFiles, TakeTheirNamesTogetherOrNotAtAll) {
  const TemporaryFolder folder;
  for (const char* name : {"a.txt", "b.txt"}) folder.write(name, std::string("earlier"));
  {
    WholeFiles files;
    files.add(folder.path("a.txt"), "new");
    const FullDisk full(10);
    EXPECT_THAT(input_error_of([&] { files.add(folder.path("b.txt"), std::string(1000, 'x')); }),
                HasSubstr("b.txt"));
  }
  EXPECT_EQ(folder.read("a.txt"), "earlier");
  WholeFiles files;
  for (const char* name : {"a.txt", "b.txt"}) files.add(folder.path(name), "new");
  EXPECT_EQ(folder.read("b.txt"), "earlier");
  files.keep();
  EXPECT_EQ(folder.read("a.txt") + folder.read("b.txt"), "newnew");
}

}  // namespace
}  // namespace stillpoint
