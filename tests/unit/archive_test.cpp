#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <random>
#include <regex>

#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/archive/archive_index.hpp"
#include "core/sequence/archive/cache_folder.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/support/archive_writer.hpp"
#include "tests/support/hash_of_run.hpp"
#include "tests/unit/bag_example.hpp"
#include "tests/unit/input_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A text as gzip has it, stored.
std::string packed_text(const std::string& text) {
  const auto size = static_cast<std::uint16_t>(text.size());
  const auto number = [](auto value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  return std::string("\x1f\x8b\x08\0\0\0\0\0\0\3\1", 11) + number(size) +
         number(static_cast<std::uint16_t>(~size)) + text +
         number(static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const unsigned char*>(text.data()),
                                                   static_cast<unsigned>(text.size())))) +
         number(static_cast<std::uint32_t>(size));
}

/// A folder for the cache alone.
class Archives : public ::testing::Test {
 protected:
  Archives() : before_(std::getenv("XDG_CACHE_HOME")) {
    ::setenv("XDG_CACHE_HOME", cache_.path().c_str(), 1);
  }
  ~Archives() override {
    ::setenv("XDG_CACHE_HOME", before_.c_str(), 1);
    ::unsetenv("STILLPOINT_CACHE_GB");
  }
  [[nodiscard]] std::vector<fs::path> kept() const {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(cache_.path("stillpoint"), none))
      files.push_back(entry.path());
    return files;
  }
  /// A packed InputFolder.
  [[nodiscard]] std::string packed(const std::string& kind, const std::string& top = "") const {
    const std::string path = places_.path("walk." + std::string(kind.starts_with("zip") ? "zip" : kind));
    write_archive(path, input_.folder.path(), kind, top);
    return path;
  }

  std::string before_;
  TemporaryFolder cache_{"cache"}, places_{"archives"};
  InputFolder input_;
};

TEST_F(Archives, EveryKindGivesTheFoldersFrames) {
  for (const char* kind : {"tar", "gnutar", "tgz", "tar.bz2", "tar.xz", "zip", "zip_stored", "7z"})
    for (const std::string& top : {std::string(), std::string("rgbd_dataset_freiburg2_test"),
                                   std::string("a/b/c"), std::string(130, 'n')}) {
      SCOPED_TRACE(kind + (" " + top));
      const auto source = open_sequence(packed(kind, top));
      expect_whole(*source);
      EXPECT_THAT(source->warnings(), IsEmpty());
      EXPECT_EQ(source->camera().name, "own");
      EXPECT_EQ(source->name(), top.empty() ? "walk" : fs::path(top).filename().string());
    }
}

TEST_F(Archives, GiveTheFoldersRun) {
  const TemporaryFolder folder("walk");
  OpenOptions options;
  options.frames = 8;
  write_sequence(*open_sequence("generated:walking_static", options), folder.path());
  const auto unpacked = open_sequence(folder.path());
  const std::string expected = hash_of_run(*unpacked);
  for (const char* kind : {"tgz", "zip"}) {
    const std::string path = places_.path(std::string("run.") + kind);
    write_archive(path, folder.path(), kind, "walk");
    for (int time = 0; time < 2; ++time) {  // unpacked, and found unpacked
      const auto source = open_sequence(path);
      EXPECT_EQ(hash_of_run(*source), expected) << kind;
      ASSERT_TRUE(source->has_masks());
      EXPECT_EQ(cv::norm(source->truth(3).moving, unpacked->truth(3).moving, cv::NORM_INF), 0);
      EXPECT_EQ(source->ground_truth().size(), unpacked->ground_truth().size());
    }
  }
}

TEST_F(Archives, NamesTellTheCameraAsFoldersDo) {
  fs::remove(input_.folder.path("camera.toml"));
  EXPECT_EQ(open_sequence(packed("tar", "rgbd_dataset_freiburg2_test"))->camera().name, "freiburg2");
  const std::string path = places_.path("rgbd_bonn_walk.tar.bz2");
  write_archive(path, input_.folder.path(), "tar.bz2", "");
  EXPECT_EQ(open_sequence(path)->camera().name, "bonn");
  EXPECT_EQ(open_sequence(path)->name(), "rgbd_bonn_walk");
}

TEST_F(Archives, AreFoldersOfImagesToo) {
  for (const char* list : {"rgb.txt", "depth.txt", "groundtruth.txt", "camera.toml"})
    fs::remove(input_.folder.path(list));
  fs::remove_all(input_.folder.path("depth"));
  const auto source = open_sequence(packed("zip"));
  EXPECT_EQ(source->size(), kInputFrames);
  EXPECT_EQ(source->name(), "walk");
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("walk.zip/rgb: nothing lists its 12 images")));
}

TEST_F(Archives, AreUnpackedOnceIntoTheCacheAndAnewWhenTheyChange) {
  const std::string path = packed("tgz");
  expect_whole(*open_sequence(path));
  ASSERT_EQ(kept().size(), 1U);
  const fs::path copy = kept().front();
  const auto written = fs::file_size(copy);
  // What is found is used: a copy that was spoilt shows.
  fs::resize_file(copy, written / 2);
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(path); }), HasSubstr("is cut off"));
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(1));
  expect_whole(*open_sequence(path));
  EXPECT_EQ(kept().size(), 2U);
  // What is read as it lies needs no cache.
  for (const char* kind : {"tar", "zip", "zip_stored"}) expect_whole(*open_sequence(packed(kind)));
  EXPECT_EQ(kept().size(), 2U);
}

TEST_F(Archives, TheCacheStaysBelowItsLimit) {
  const std::string path = packed("tgz");
  expect_whole(*open_sequence(path));
  fs::last_write_time(kept().front(), fs::file_time_type::clock::now() - std::chrono::hours(1));
  const fs::path first = kept().front();
  // Room for one and a half.
  ::setenv("STILLPOINT_CACHE_GB",
           fmt::format("{}", 1.5e-9 * static_cast<double>(fs::file_size(first))).c_str(), 1);
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(1));
  expect_whole(*open_sequence(path));
  ASSERT_EQ(kept().size(), 1U);
  EXPECT_NE(kept().front(), first);
  ::setenv("STILLPOINT_CACHE_GB", "0.00000001", 1);
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(1));
  EXPECT_THAT(input_error_of([&] { (void)open_sequence(path); }), HasSubstr("STILLPOINT_CACHE_GB"));
  for (const fs::path& file : kept()) EXPECT_THAT(file.string(), Not(HasSubstr(".part-")));
}

TEST_F(Archives, WhatEndsUnpackingLeavesNothingHalf) {
  struct Stopped {};
  OpenOptions options;
  int told = 0;
  options.progress = [&](const std::string& what, double) {
    EXPECT_THAT(what, HasSubstr("walk.tgz"));
    ++told;
    throw Stopped();
  };
  EXPECT_THROW((void)open_sequence(packed("tgz"), options), Stopped);
  EXPECT_EQ(told, 1);
  EXPECT_THAT(kept(), IsEmpty());
  // What a killed program left goes away; process 1 is another's and runs. A home folder may be another
  // machine's as well, whose processes nobody here knows.
  std::array<char, 256> host{};
  ASSERT_EQ(::gethostname(host.data(), host.size() - 1), 0);
  const std::string here = std::regex_replace(std::string(host.data()), std::regex("[^A-Za-z0-9]"), "_");
  const auto part = [](const std::string& writer) { return "stillpoint/a.unpacked.part-" + writer + "-0"; };
  const std::string killed = part(here + "-999999999"), running = part(here + "-1"),
                    elsewhere = part("node7-999999999"), forsaken = part("node8-999999999");
  fs::create_directories(cache_.path("stillpoint"));
  for (const std::string& name : {killed, running, elsewhere, forsaken})
    cache_.write(name, std::string("half"));
  fs::last_write_time(cache_.path(forsaken), fs::file_time_type::clock::now() - std::chrono::hours(25));
  expect_whole(*open_sequence(packed("tgz")));
  EXPECT_FALSE(fs::exists(cache_.path(killed)));
  EXPECT_TRUE(fs::exists(cache_.path(running)));
  EXPECT_TRUE(fs::exists(cache_.path(elsewhere)));
  EXPECT_FALSE(fs::exists(cache_.path(forsaken)));
}

TEST_F(Archives, WithoutAPlaceToUnpackItIsSaid) {
  cache_.write("stillpoint", std::string("a file"));
  const std::string sentence = input_error_of([&] { (void)open_sequence(packed("tgz")); });
  EXPECT_THAT(sentence, HasSubstr("walk.tgz: cannot be unpacked into"));
  EXPECT_THAT(sentence, HasSubstr("XDG_CACHE_HOME"));
}

TEST_F(Archives, CutOffTheyGiveWhatTheyHold) {
  std::mt19937 random(9);
  for (int i = 0; i < kInputFrames; ++i) {
    cv::Mat noise(120, 160, CV_8UC3);
    for (int at = 0; at < noise.rows * noise.cols * 3; ++at)
      noise.data[at] = static_cast<unsigned char>(random());
    input_.folder.write(fmt::format("rgb/{}.png", i), noise);
  }
  for (const char* kind : {"tar", "tgz", "zip", "zip_stored"}) {
    SCOPED_TRACE(kind);
    const std::string path = packed(kind);
    // The lists come last: what is left has images, which are read by their names.
    fs::resize_file(path, fs::file_size(path) * 7 / 10);
    const auto source = open_sequence(path);
    EXPECT_GE(source->size(), 6);
    EXPECT_THAT(source->warnings(), Contains(HasSubstr("is cut off")));
    // Images of the depth alone are no sequence, which is said with the reason.
    fs::resize_file(path, 600);
    EXPECT_NE(input_error_of([&] { (void)open_sequence(path); }), "");
  }
}

TEST_F(Archives, DamageIsASentenceOrAMarkedFrame) {
  std::mt19937 random(5);
  const auto any = [&](std::size_t below) {
    return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
  };
  for (const char* kind : {"tar", "tgz", "tar.bz2", "zip", "zip_stored", "7z"}) {
    const std::string name = fs::path(packed(kind)).filename().string(), whole = places_.read(name);
    int opened = 0, refused = 0;
    for (int round = 0; round < 60; ++round) {
      std::string bytes = whole;
      for (std::size_t faults = 1 + any(6); faults > 0; --faults)
        bytes[any(2) == 0 ? any(bytes.size())
                          : bytes.size() - 1 - any(std::min<std::size_t>(bytes.size(), 3000))] =
            static_cast<char>(any(256));
      if (any(3) == 0) bytes.resize(any(bytes.size()));
      places_.write(name, bytes);
      try {
        const auto source = open_sequence(places_.path(name));
        for (int i = 0; i < source->size(); ++i) (void)source->read(i);
        ++opened;
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        ++refused;
      }
    }
    EXPECT_EQ(opened + refused, 60) << kind;
    EXPECT_GT(refused, 0) << kind;
  }
}

TEST_F(Archives, WhatIsNoneIsSaidToBeNone) {
  const auto sentence = [&](const std::string& name, const std::string& bytes) {
    places_.write(name, bytes);
    return input_error_of([&] { (void)open_sequence(places_.path(name)); });
  };
  EXPECT_THAT(sentence("a.tgz", "hello"), HasSubstr("is a file, expected a folder"));
  EXPECT_THAT(sentence("a.tgz", ""), HasSubstr("is an empty file, expected a folder"));
  EXPECT_THAT(sentence("a.tar", std::string(2048, '\0')), HasSubstr("is no archive that can be read"));
  EXPECT_THAT(sentence("a.zip", std::string("PK\5\6") + std::string(18, '\0')), HasSubstr("without files"));
  EXPECT_THAT(sentence("b.tgz", "\x1f\x8b" + std::string(30, 'x')),
              HasSubstr("is no archive that can be read"));
  EXPECT_THAT(sentence("c.tgz", std::string("\x1f\x8b\x08\0\0\0\0\0\0\3", 10) + std::string(30, 'x')),
              HasSubstr("c.tgz: cannot be unpacked"));
  EXPECT_THAT(sentence("d.gz", packed_text("no archive")),
              HasSubstr("d.gz: holds neither an archive nor a bag"));
}

TEST_F(Archives, SentencesStayOneLineWhateverTheyQuote) {
  input_.folder.write("camera.toml", std::string("\"a\\nb\" = 1\n"));
  EXPECT_THAT(input_error_of([&] { (void)input_.open(); }), HasSubstr("a?b is no key of a camera"));
}

TEST_F(Archives, NamesThatLeadOutAreLeftOut) {
  EXPECT_EQ(archived_name("./a/./b.png"), "a/b.png");
  EXPECT_EQ(archived_name("/a/b.png"), "a/b.png");
  EXPECT_EQ(archived_name("a\\b.png"), "a/b.png");
  EXPECT_EQ(archived_name("a\nb.png"), "a?b.png");
  for (const char* name : {"../a", "a/../../b", "..", ".", "", "__MACOSX/a", "a/._b.png", "a/.DS_Store"})
    EXPECT_EQ(archived_name(name), "") << name;
}

TEST_F(Archives, LinksInATarArchiveAreFollowed) {
  const std::string folder = input_.folder.path();
  const std::string commands = fmt::format(
      "cd {} && mv camera.toml own.toml && ln -s own.toml camera.toml && mv rgb.txt depth/list && "
      "ln -s depth/list rgb.txt && ln depth.txt z.txt && tar cf {} .",
      folder, places_.path("links.tar"));
  ASSERT_EQ(std::system(commands.c_str()), 0);
  const auto source = open_sequence(places_.path("links.tar"));
  expect_whole(*source);
  EXPECT_EQ(source->camera().name, "own");
}

TEST_F(Archives, APackedBagIsABag) {
  const std::string bag = places_.path("walk.bag"), packed_bag = places_.path("walk.bag.gz");
  write_ros1_bag(bag, messages_of(*input_.open()));
  const std::string bytes = places_.read("walk.bag");
  const gzFile file = gzopen(packed_bag.c_str(), "wb1");
  ASSERT_EQ(gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size())), static_cast<int>(bytes.size()));
  gzclose(file);
  const auto source = open_sequence(packed_bag);
  expect_whole(*source);
  EXPECT_THAT(source->contents(), Contains(HasSubstr("read as colour")));
  EXPECT_EQ(source->name(), "walk.bag");
}

TEST_F(Archives, SlowBagsAreUnpackedIntoTheCache) {
  std::mt19937 random(3);
  std::vector<LogMessage> messages;
  for (int i = 0; i < 8; ++i) {
    cv::Mat noise(480, 640, CV_8UC3);
    for (int y = 0; y < noise.rows; ++y)
      for (int x = 0; x < 3 * noise.cols; ++x) noise.ptr(y)[x] = static_cast<unsigned char>(random());
    const std::int64_t stamp = 1'300'000'000'000'000'000 + i * 33'000'000LL;
    messages.push_back(
        {"/rgb/image", "sensor_msgs/Image", stamp, image_bytes(false, stamp, "c", "bgr8", noise)});
  }
  const std::string plain = places_.path("plain.bag"), slow = places_.path("slow.bag");
  write_ros1_bag(plain, messages), write_ros1_bag(slow, messages, "bz2");
  const auto expected = open_sequence(plain);
  EXPECT_THAT(kept(), IsEmpty());
  const auto same = [&](const std::string& path) {
    const auto source = open_sequence(path);
    EXPECT_EQ(source->warnings(),
              expected->warnings().size() == 1
                  ? std::vector<std::string>{fmt::format(
                        "{}: holds no sensor_msgs/CameraInfo of the colour images; ros_default is "
                        "assumed (--camera NAME|FILE says which)",
                        path)}
                  : std::vector<std::string>{});
    ASSERT_EQ(source->size(), 8);
    for (int i = 0; i < 8; ++i)
      EXPECT_EQ(cv::norm(source->read(i).colour, expected->read(i).colour, cv::NORM_INF), 0);
  };
  same(slow);
  EXPECT_EQ(kept().size(), 1U);
  same(slow);
  EXPECT_EQ(kept().size(), 1U);
  // Cut off, it is so unpacked too.
  fs::resize_file(slow, fs::file_size(slow) / 2);
  const auto half = open_sequence(slow);
  EXPECT_THAT(half->warnings(), Contains(HasSubstr("slow.bag: is cut off")));
  EXPECT_GE(half->size(), 3);
}

}  // namespace
}  // namespace stillpoint
