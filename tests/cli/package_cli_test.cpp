// What comes with the program where it is installed: man pages, completions, desktop files, and the package.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "core/version.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

/// A line of the shell: its status, and all that it printed.
struct ShellResult {
  int exit_code = -1;
  std::string said;
};

ShellResult shell(const std::string& line) {
  const CliResult result = CliProcess({"-c", "exec 2>&1; " + line}, "/bin/bash").wait();
  return {result.exit_code, result.out};
}

bool there_is(const std::string& tool) { return shell("command -v " + tool).exit_code == 0; }

/// What every match of `pattern`'s first group in `text` is.
std::set<std::string> all_matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return {std::sregex_token_iterator(text.begin(), text.end(), regex, 1), {}};
}

/// The manual as the program writes it.
class Manual : public testing::Test {
 protected:
  void SetUp() override {
    const CliResult result =
        run_cli({"manual", "--man", folder_.path("man"), "--completions", folder_.path("completions")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  /// What bash would offer for the last of `words`.
  std::string offered_by_bash(const std::string& words) const {
    return shell("source '" + folder_.path("completions/stillpoint") + "'; COMP_WORDS=(" + words +
                 "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _stillpoint; echo ${COMPREPLY[*]}")
        .said;
  }

  TemporaryFolder folder_;
};

TEST_F(Manual, HasAPageACommandWithEveryOptionOfItsHelp) {
  const std::string help = run_cli({"--help"}).out;
  const auto commands = all_matches(help.substr(help.find("Subcommands:")), "\n  ([a-z]+) ");
  ASSERT_THAT(commands, IsSupersetOf({"run", "view", "snapshot", "manual"}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path("man")), {}),
            static_cast<std::ptrdiff_t>(commands.size() + 1));
  for (const std::string& command : commands) {
    EXPECT_THAT(folder_.read("man/stillpoint.1"), HasSubstr(".BR stillpoint\\-" + command + " (1)"));
    const std::string page = folder_.read("man/stillpoint-" + command + ".1");
    const auto options = all_matches(run_cli({command, "--help"}).out, "\n  (?:-h,)?--([a-z-]+)");
    EXPECT_THAT(options, testing::Contains("help")) << command;
    for (const std::string& option : options)
      EXPECT_THAT(page,
                  HasSubstr("\\fB\\-\\-" + std::regex_replace(option, std::regex("-"), "\\-") + "\\fR"));
  }
}

TEST_F(Manual, IsReadByManWithoutAWarning) {
  if (!there_is("man")) GTEST_SKIP() << "there is no man";
  const std::string run =
      shell("LC_ALL=C.UTF-8 man --warnings -l '" + folder_.path("man/stillpoint-run.1") + "'").said;
  EXPECT_THAT(run, HasSubstr("stillpoint run [OPTIONS] [SEQUENCE]"));
  EXPECT_THAT(run, HasSubstr("--measure-unit"));
  for (const auto& page : fs::directory_iterator(folder_.path("man")))
    EXPECT_EQ(shell("LC_ALL=C.UTF-8 man --warnings -l '" + page.path().string() + "' 2>&1 >/dev/null").said,
              "")
        << page.path();
}

TEST_F(Manual, BashOffersCommandsOptionsAndValues) {
  EXPECT_EQ(offered_by_bash("stillpoint ru"), "run\n");
  EXPECT_EQ(offered_by_bash("stillpoint run --me"), "--measure-unit --method\n");
  EXPECT_EQ(offered_by_bash("stillpoint run --method pe"), "peng2017\n");
  EXPECT_EQ(offered_by_bash("stillpoint evaluate --quaternion ''"), "xyzw wxyz\n");
  EXPECT_EQ(offered_by_bash("stillpoint run --out ''"), "\n") << "files, which bash has by itself";
}

TEST_F(Manual, FishOffersCommandsOptionsAndValues) {
  if (!there_is("fish")) GTEST_SKIP() << "there is no fish";
  const auto offered = [this](const std::string& line) {
    return shell("HOME=" + folder_.path() + " fish -c 'source " +
                 folder_.path("completions/stillpoint.fish") + "; complete -C \"" + line + "\"'")
        .said;
  };
  EXPECT_THAT(offered("stillpoint ru"), testing::StartsWith("run\t"));
  EXPECT_THAT(offered("stillpoint run --measu"), testing::StartsWith("--measure-unit\t"));
  EXPECT_THAT(offered("stillpoint run --method pe"), testing::StartsWith("peng2017\t"));
}

TEST_F(Manual, ZshReadsItsCompletions) {
  EXPECT_THAT(folder_.read("completions/_stillpoint"), testing::StartsWith("#compdef stillpoint\n"));
  EXPECT_THAT(folder_.read("completions/_stillpoint"), HasSubstr(":TEXT:(xyzw wxyz)'"));
  if (!there_is("zsh")) GTEST_SKIP() << "there is no zsh";
  EXPECT_EQ(shell("zsh -n '" + folder_.path("completions/_stillpoint") + "'").said, "");
}

TEST(ManualCommand, SaysWhereItCannotWrite) {
  expect_usage_error(run_cli({"manual"}), "--man or --completions is required");
  expect_one_sentence(run_cli({"manual", "--man", "/dev/null/man"}), "/dev/null/man: cannot be made");
}

const std::string& desktop() {
  static const std::string path = places::source() + "/assets/desktop";
  return path;
}

TEST(DesktopFiles, AllSpeakOfTheSameVersion) {
  const std::string version = STILLPOINT_VERSION;
  EXPECT_EQ(version, fmt::format("{}.{}.{}", STILLPOINT_VERSION_MAJOR, STILLPOINT_VERSION_MINOR,
                                 STILLPOINT_VERSION_PATCH));
  EXPECT_THAT(run_cli({"--version"}).out, testing::StartsWith("stillpoint " + version + " "));
  EXPECT_THAT(shell("head -1 " + desktop() + "/changelog").said,
              testing::StartsWith("stillpoint (" + version + ") "));
  EXPECT_THAT(shell("grep -m1 '<release ' " + desktop() + "/*.metainfo.xml").said,
              HasSubstr("version=\"" + version + "\""));
}

TEST(DesktopFiles, TheEntryIsValid) {
  if (!there_is("desktop-file-validate")) GTEST_SKIP() << "there is no desktop-file-validate";
  const ShellResult result = shell("desktop-file-validate " + desktop() + "/stillpoint.desktop");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.said, "");
}

TEST(DesktopFiles, TheMetadataIsValid) {
  if (!there_is("appstreamcli")) GTEST_SKIP() << "there is no appstreamcli";
  const ShellResult result =
      shell("appstreamcli validate --no-net --strict " + desktop() + "/*.metainfo.xml");
  EXPECT_EQ(result.exit_code, 0) << result.said;
}

TEST(DesktopFiles, ARunFolderHasATypeOfItsOwn) {
  if (!there_is("update-mime-database")) GTEST_SKIP() << "there is no update-mime-database";
  const TemporaryFolder folder;
  fs::create_directories(folder.path("mime/packages"));
  fs::copy(desktop() + "/stillpoint-mime.xml", folder.path("mime/packages/stillpoint.xml"));
  const ShellResult result =
      shell("XDG_DATA_DIRS='" + folder.path() + "' update-mime-database '" + folder.path("mime") + "'");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.said, "");
  EXPECT_THAT(
      folder.read("mime/treemagic"),
      HasSubstr("x-content/x-stillpoint-run]\n>\"records.bin\"=file,match-case\n1>\"config.toml\"=file"));
  EXPECT_THAT(folder.read("mime/magic"), HasSubstr("STILLREC"));
}

TEST(Package, OfTheProgramHoldsItAndNamesWhatItNeeds) {
  for (const char* tool : {"cpack", "dpkg-shlibdeps", "dpkg-deb", "file"})
    if (!there_is(tool)) GTEST_SKIP() << "there is no " << tool;
  const TemporaryFolder folder;
  const ShellResult made =
      shell("cd '" + places::build() + "' && cpack --config CPackConfig.cmake -B '" + folder.path() +
            "' -D CPACK_COMPONENTS_ALL=program -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip");
  ASSERT_EQ(made.exit_code, 0) << made.said;
  const std::string package = "'" + folder.path() + "'/stillpoint_*.deb";
  const std::string files = shell("dpkg-deb -c " + package).said;
  for (const char* file :
       {"./usr/bin/stillpoint", "./usr/share/stillpoint/presets/paper.toml",
        "./usr/share/applications/stillpoint.desktop",
        "./usr/share/icons/hicolor/scalable/apps/stillpoint.svg", "./usr/share/mime/packages/stillpoint.xml",
        "./usr/share/man/man1/stillpoint-run.1.gz", "./usr/share/bash-completion/completions/stillpoint",
        "./usr/share/zsh/vendor-completions/_stillpoint",
        "./usr/share/fish/vendor_completions.d/stillpoint.fish", "./usr/share/doc/stillpoint/copyright"})
    EXPECT_THAT(files, HasSubstr(std::string(file) + "\n"));
  EXPECT_THAT(files, Not(HasSubstr("/include/")));
  const std::string needs = shell("dpkg-deb -f " + package + " Depends").said;
  EXPECT_THAT(needs, HasSubstr("libc6 (>= "));
  EXPECT_THAT(needs, HasSubstr("libopencv-calib3d"));
  EXPECT_THAT(needs, Not(HasSubstr("libopencv-imgcodecs"))) << "170 packages, which the module alone needs";
  EXPECT_THAT(needs, Not(HasSubstr("-dev")));
  if (!there_is("lintian")) GTEST_SKIP() << "what can be known without lintian holds; there is no lintian";
  EXPECT_EQ(shell("lintian --allow-root --fail-on none " + package).said, "");
}

}  // namespace
}  // namespace stillpoint
