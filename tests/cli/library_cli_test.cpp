// The installed library, as a program of somebody else's uses it: tests/consumer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/media/image_codec.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Runs cmake; what it says is the folder's `log`. @returns its status
int run_cmake(const TemporaryFolder& folder, const std::string& arguments) {
  return std::system(
      ("'" + places::cmake() + "' " + arguments + " > '" + folder.path("log") + "' 2>&1").c_str());
}

/// Has the tree installed as `folder`/usr, moved there from where it was installed.
void install_into(const TemporaryFolder& folder) {
  ASSERT_EQ(run_cmake(folder, "--install '" + places::build() + "' --prefix '" + folder.path("first") + "'"),
            0)
      << folder.read("log");
  fs::rename(folder.path("first"), folder.path("usr"));
}

/// Configures a project against it.
int configure(const TemporaryFolder& folder, const std::string& project) {
  return run_cmake(folder, "-S '" + project + "' -B '" + folder.path("build") +
                               "' -G Ninja -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH='" +
                               folder.path("usr") + "'");
}

TEST(InstalledLibrary, AProgramOnItRunsAMethodOfItsOwn) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "a program on the library is not built with the sanitizers";
#endif
  const TemporaryFolder folder;
  install_into(folder);
  ASSERT_EQ(configure(folder, places::source() + "/tests/consumer"), 0) << folder.read("log");
  ASSERT_EQ(run_cmake(folder, "--build '" + folder.path("build") + "'"), 0) << folder.read("log");

  // A TIFF is the module's affair, which has to be found; and so has the preset.
  const CliResult result = CliProcess({folder.path("stages.tiff")}, folder.path("build/consumer")).wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              testing::MatchesRegex("RPE 1 s 0\\.0[0-9]+ m, IoU 0\\.[0-9]+, stage 'Grey difference'\n"));
  const std::string bytes = folder.read("stages.tiff");
  const cv::Mat picture = decode_pixels({bytes.begin(), bytes.end()});
  EXPECT_EQ(picture.size(), cv::Size(1600, 900));
}

TEST(InstalledLibrary, AComponentThatThereIsNotIsRefusedInASentence) {
  const TemporaryFolder folder;
  install_into(folder);
  folder.write("project/CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.25)\nproject(refused LANGUAGES CXX)\n"
               "find_package(Stillpoint REQUIRED COMPONENTS window)\n");
  EXPECT_NE(configure(folder, folder.path("project")), 0);
  EXPECT_THAT(folder.read("log"), testing::HasSubstr("Stillpoint has no component 'window'"));
}

}  // namespace
}  // namespace stillpoint
