#include "core/inspect/openable.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

bool is_place(const OpenPlace& place, const char* name, PlaceKind kind) {
  return place.name == name && place.kind == kind;
}

TEST(Openable, FoldersComeFirstAndNumbersGoByTheirValue) {
  const TemporaryFolder folder;
  for (const char* name : {"run10/a/x", "run9/a/x", "Beta/x", "alpha/x", "room/rgb.txt", "frames/0001.png",
                           ".hidden/rgb.txt", "notes.txt"})
    folder.write(name, std::string("x"));
  folder.write("film.bag", std::string("#ROSBAG V2.0\n"));
  const std::vector<OpenPlace> places = places_in(folder.path());
  ASSERT_EQ(places.size(), 7U);
  EXPECT_TRUE(is_place(places[0], "alpha", PlaceKind::folder));
  EXPECT_TRUE(is_place(places[1], "Beta", PlaceKind::folder));
  EXPECT_TRUE(is_place(places[2], "frames", PlaceKind::sequence));
  EXPECT_TRUE(is_place(places[3], "room", PlaceKind::sequence));
  EXPECT_TRUE(is_place(places[4], "run9", PlaceKind::folder));
  EXPECT_TRUE(is_place(places[5], "run10", PlaceKind::folder));
  EXPECT_TRUE(is_place(places[6], "film.bag", PlaceKind::file));
}

TEST(Openable, WhatIsNoPlaceIsNone) {
  const TemporaryFolder folder;
  folder.write("notes.txt", std::string("words"));
  EXPECT_EQ(kind_of_place(folder.path()), PlaceKind::folder);
  EXPECT_FALSE(kind_of_place(folder.path("notes.txt")));
  EXPECT_FALSE(kind_of_place(folder.path("nowhere")));
  EXPECT_THAT([&] { (void)places_in(folder.path("nowhere")); },
              ThrowsMessage<InputError>(HasSubstr("nowhere: cannot be read")));
}

TEST(Openable, ASequenceIsToldByItsFacts) {
  const SmallSequence folder(4);
  EXPECT_EQ(kind_of_place(folder.path()), PlaceKind::sequence);
  const auto source = open_sequence(folder.path());
  const std::vector<SequenceFact> facts = sequence_facts(*source);
  std::vector<std::string> names;
  for (const SequenceFact& fact : facts) names.push_back(fact.name);
  ASSERT_THAT(names, ElementsAre("Frames", "Camera", "Depth", "Masks", "Ground truth"));
  EXPECT_THAT(facts[0].value, HasSubstr("4 frames, "));
  EXPECT_THAT(facts[1].value, HasSubstr(source->camera().name));
  EXPECT_EQ(facts[3].value, source->has_masks() ? "yes" : "none");
}

}  // namespace
}  // namespace stillpoint
