#include "ui/workbench/layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "ui/panels/panel_choices.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::string> kKnown = {"a", "b", "c", "d"};

LayoutNode from(const std::string& json) { return parse_layout(json, "file.json", kKnown); }

std::string layout_complaint(const std::string& json) {
  try {
    (void)from(json);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Columns of 0.25 and 0.75, the second divided into rows of 0.4 and 0.6.
const char* const kThree =
    R"({"columns": [{"share": 0.25, "panel": "a"},
                    {"share": 0.75, "rows": [{"share": 0.4, "panel": "b"}, {"share": 0.6, "panel": "c"}]}]})";

TEST(Layout, LiesWhereItsSharesSay) {
  // 1004 px less a gap of 4 is 1000: 250 and 750. 504 less 4 is 500: 200 and 300.
  const PlacedLayout placed = arrange(from(kThree), {10, 20, 1004, 504}, 4);
  ASSERT_EQ(placed.panels.size(), 3U);
  EXPECT_EQ(placed.panels[0].rect, (LayoutRect{10, 20, 250, 504}));
  EXPECT_EQ(placed.panels[1].rect, (LayoutRect{264, 20, 750, 200}));
  EXPECT_EQ(placed.panels[2].rect, (LayoutRect{264, 224, 750, 300}));
  ASSERT_EQ(placed.splitters.size(), 2U);
  EXPECT_EQ(placed.splitters[0].rect, (LayoutRect{260, 20, 4, 504}));
  EXPECT_EQ(placed.splitters[1].rect, (LayoutRect{264, 220, 750, 4}));
  EXPECT_TRUE(placed.splitters[0].upright);
  EXPECT_FALSE(placed.splitters[1].upright);
}

TEST(Layout, LeavesNoPixelUnused) {
  const LayoutNode root = from(
      R"({"columns": [{"share": 1, "panel": "a"}, {"share": 1, "panel": "b"}, {"share": 1, "panel": "c"}]})");
  for (float width = 100; width < 140; ++width) {
    const PlacedLayout placed = arrange(root, {0, 0, width, 50}, 3);
    float x = 0;
    ASSERT_EQ(placed.panels.size(), 3U);
    for (const PlacedPanel& panel : placed.panels) {
      EXPECT_EQ(panel.rect.x, x);
      EXPECT_EQ(panel.rect.width, std::round(panel.rect.width));
      x += panel.rect.width + 3;
    }
    EXPECT_EQ(x - 3, width);
  }
}

TEST(Layout, ASplitterMovesBothItsNeighboursAlone) {
  LayoutNode root = from(kThree);
  const PlacedLayout before = arrange(root, {0, 0, 1004, 504}, 4);
  drag(root, before.splitters[0], 50, 90);
  const PlacedLayout after = arrange(root, {0, 0, 1004, 504}, 4);
  EXPECT_EQ(after.panels[0].rect.width, 300);
  EXPECT_EQ(after.panels[1].rect.width, 700);
  EXPECT_EQ(after.panels[1].rect.height, before.panels[1].rect.height);
}

TEST(Layout, ASplitterStopsBeforeATileVanishes) {
  LayoutNode root = from(kThree);
  drag(root, arrange(root, {0, 0, 1004, 504}, 4).splitters[0], -5000, 90);
  EXPECT_EQ(arrange(root, {0, 0, 1004, 504}, 4).panels[0].rect.width, 90);
  drag(root, arrange(root, {0, 0, 1004, 504}, 4).splitters[0], 5000, 90);
  EXPECT_EQ(arrange(root, {0, 0, 1004, 504}, 4).panels[1].rect.width, 90);
}

const LeastOf kHundred = [](const std::string&) { return TileSize{100, 100}; };

TEST(Layout, ATileThatNeedsMoreTakesItFromItsSiblings) {
  const LayoutNode root =
      from(R"({"columns": [{"share": 0.1, "panel": "a"}, {"share": 0.9, "panel": "b"}]})");
  const PlacedLayout placed = arrange(root, {0, 0, 504, 200}, 4, kHundred);
  EXPECT_EQ(placed.panels[0].rect, (LayoutRect{0, 0, 100, 200}));
  EXPECT_EQ(placed.panels[1].rect, (LayoutRect{104, 0, 400, 200}));
  EXPECT_TRUE(placed.panels[0].tabs.empty());
}

TEST(Layout, NeighboursWithoutRoomShareATile) {
  // Three of 100 px and two gaps need 308: in 300 the last two are one.
  const LayoutNode root = from(
      R"({"columns": [{"share": 1, "panel": "a"}, {"share": 1, "panel": "b"}, {"share": 2, "panel": "c"}]})");
  const PlacedLayout placed = arrange(root, {0, 0, 300, 100}, 4, kHundred);
  ASSERT_EQ(placed.panels.size(), 2U);
  EXPECT_EQ(placed.panels[0].rect, (LayoutRect{0, 0, 100, 100}));
  EXPECT_EQ(placed.panels[1].panel, "c") << "what had the most room is seen";
  EXPECT_THAT(placed.panels[1].tabs, ElementsAre("b", "c"));
  EXPECT_EQ(arrange(root, {0, 0, 308, 100}, 4, kHundred).panels.size(), 3U);
}

TEST(Layout, DivisionsThatShareAPlacePairTheirParts) {
  const LayoutNode root = from(R"({"columns": [{"share": 1, "rows": [{"panel": "a"}, {"panel": "b"}]},
                                               {"share": 1, "rows": [{"panel": "c"}, {"panel": "d"}]}]})");
  const PlacedLayout wide = arrange(root, {0, 0, 204, 204}, 4, kHundred);
  EXPECT_EQ(wide.panels.size(), 4U);
  const PlacedLayout narrow = arrange(root, {0, 0, 150, 204}, 4, kHundred);
  ASSERT_EQ(narrow.panels.size(), 2U);
  EXPECT_THAT(narrow.panels[0].tabs, ElementsAre("a", "c"));
  EXPECT_THAT(narrow.panels[1].tabs, ElementsAre("b", "d"));
  const PlacedLayout tiny = arrange(root, {0, 0, 50, 50}, 4, kHundred);
  ASSERT_EQ(tiny.panels.size(), 1U);
  EXPECT_THAT(tiny.panels[0].tabs, ElementsAre("a", "c", "b", "d"));
  EXPECT_EQ(tiny.panels[0].rect, (LayoutRect{0, 0, 50, 50}));
}

TEST(Layout, NothingChangesPlacesWhileASplitterIsDragged) {
  LayoutNode root = from(R"({"columns": [{"share": 0.4, "panel": "a"}, {"share": 0.3, "panel": "b"},
                                         {"share": 0.2, "panel": "c"}, {"share": 0.1, "panel": "d"}]})");
  const LayoutRect area{0, 0, 320, 100};
  PlacedLayout placed = arrange(root, area, 4, kHundred);
  ASSERT_EQ(placed.panels.size(), 3U);
  for (const float delta : {3.0F, 3.0F, -5.0F, 40.0F, -90.0F}) {
    const float before = placed.panels[0].rect.width;
    drag(root, placed.splitters[0], delta, 10);
    const PlacedLayout next = arrange(root, area, 4, kHundred);
    ASSERT_EQ(next.panels.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(next.panels[i].tabs, placed.panels[i].tabs);
      EXPECT_GE(next.panels[i].rect.width, 99.0F);
    }
    EXPECT_NEAR(next.panels[0].rect.width, std::clamp(before + delta, 100.0F, 112.0F), 1.0F);
    placed = next;
  }
}

TEST(Layout, NeighboursTakeTheRoomOfWhatIsHidden) {
  LayoutNode root = from(kThree);
  remove_panel(root, "b");
  EXPECT_THAT(panels_of(root), ElementsAre("a", "c"));
  const PlacedLayout placed = arrange(root, {0, 0, 1004, 504}, 4);
  EXPECT_EQ(placed.panels[1].rect, (LayoutRect{254, 0, 750, 504}));
  remove_panel(root, "a");
  EXPECT_TRUE(root.is_panel());
  remove_panel(root, "c");
  EXPECT_EQ(root.panel, "c");
}

TEST(Layout, PanelsChangePlaces) {
  LayoutNode root = from(kThree);
  replace_panel(root, "a", "c");
  EXPECT_THAT(panels_of(root), ElementsAre("c", "b", "a"));
  replace_panel(root, "b", "d");
  EXPECT_THAT(panels_of(root), ElementsAre("c", "d", "a"));
}

TEST(Layout, ANewPanelHalvesTheLargestTile) {
  LayoutNode root = from(kThree);
  add_panel(root, "d", {0, 0, 1000, 500});
  EXPECT_THAT(panels_of(root), ElementsAre("a", "b", "c", "d"));
  const PlacedLayout placed = arrange(root, {0, 0, 1000, 500}, 0);
  EXPECT_EQ(placed.panels[2].rect, (LayoutRect{250, 200, 375, 300}));
  EXPECT_EQ(placed.panels[3].rect, (LayoutRect{625, 200, 375, 300}));
  add_panel(root, "d", {0, 0, 1000, 500});
  EXPECT_EQ(panels_of(root).size(), 4U);
}

TEST(Layout, ComesBackFromItsFile) {
  EXPECT_EQ(from(to_json(from(kThree))), from(kThree));
  const LayoutNode standard = default_layout("stillpoint");
  EXPECT_TRUE(contains(standard, "motion"));
  EXPECT_FALSE(contains(default_layout("paper"), "motion"));
  EXPECT_EQ(parse_layout(to_json(standard), "file.json", panels_of(standard)), standard);
}

TEST(Layout, OfTheProgramsOwnFollowsTheMethodAndOneChosenStays) {
  for (const char* from : {"paper", "stillpoint", "none", "dai2020"})
    for (const char* to : {"paper", "stillpoint", "none", "dai2020"}) {
      EXPECT_EQ(panels_of(fitted(default_layout(from), to, false)), panels_of(default_layout(to)))
          << from << " to " << to;
      EXPECT_EQ(panels_of(fitted(default_layout(from), to, true)), panels_of(default_layout(to, true)));
      for (const NamedLayout& named : named_layouts())
        EXPECT_EQ(panels_of(fitted(named.make(from), to, false)), panels_of(named.make(to))) << named.name;
    }
  // Dragged edges stay where the tiles do.
  LayoutNode wider = default_layout("stillpoint");
  wider.children[0].share = 0.5, wider.children[1].share = 0.26;
  EXPECT_EQ(fitted(wider, "dai2020", false), wider);
  LayoutNode chosen = default_layout("paper");
  remove_panel(chosen, "trajectory");
  EXPECT_EQ(fitted(chosen, "stillpoint", false), chosen);
}

TEST(Layout, OfAMethodWithoutStagesHasNoTileForThem) {
  for (const NamedLayout& named : named_layouts())
    EXPECT_FALSE(contains(named.make("none"), "motion")) << named.name;
  EXPECT_TRUE(contains(default_layout("none"), "mask"));
}

TEST(Layout, SharesAreScaledAndEqualWithoutAny) {
  const LayoutNode root = from(R"({"rows": [{"panel": "a", "share": 3}, {"panel": "b", "share": 1}]})");
  EXPECT_DOUBLE_EQ(root.children[0].share, 0.75);
  EXPECT_DOUBLE_EQ(from(R"({"rows": [{"panel": "a"}, {"panel": "b"}]})").children[1].share, 0.5);
}

TEST(Layout, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT(layout_complaint("{"), HasSubstr("file.json: is no layout: not JSON"));
  EXPECT_THAT(layout_complaint(R"({"panel": "z"})"), HasSubstr("no panel 'z'; the panels are a, b, c, d"));
  EXPECT_THAT(layout_complaint(R"({"rows": [{"panel": "a"}, {"panel": "a"}]})"),
              HasSubstr("'a' is named twice"));
  EXPECT_THAT(layout_complaint(R"({"rows": []})"), HasSubstr("at least one tile"));
  EXPECT_THAT(layout_complaint("[]"), HasSubstr("must be an object"));
  EXPECT_THAT(layout_complaint(R"({"panel": "a", "rows": []})"), HasSubstr("one of"));
  EXPECT_THAT(layout_complaint(R"({"rows": [{"panel": "a", "share": -1}]})"), HasSubstr("greater than 0"));
  EXPECT_THAT(layout_complaint(R"({"rows": [{"panel": "a", "share": "x"}]})"), HasSubstr("must be a number"));
  std::string deep = R"({"panel": "a"})";
  for (int i = 0; i < 100; ++i) deep = R"({"rows": [)" + deep + "]}";
  EXPECT_THAT(layout_complaint(deep), HasSubstr("more than 32 times"));
}

TEST(LayoutJson, ChoicesOfPanelsComeBack) {
  const std::vector<std::string> known{"a", "b"};
  const std::string text =
      R"({"columns": [{"panel": "a", "choices": {"Map points": "off"}}, {"panel": "b"}]})";
  const LayoutNode layout = parse_layout(text, "f", known);
  EXPECT_EQ(layout.children[0].choices, (std::map<std::string, std::string>{{"Map points", "off"}}));
  EXPECT_TRUE(layout.children[1].choices.empty());
  EXPECT_EQ(parse_layout(to_json(layout), "f", known), layout);
  EXPECT_THROW((void)parse_layout(R"({"panel": "a", "choices": ["x"]})", "f", known), InputError);
  EXPECT_THROW((void)parse_layout(R"({"panel": "a", "choices": {"x": 1}})", "f", known), InputError);
}

TEST(LayoutJson, TheTabInFrontComesBack) {
  const std::vector<std::string> known{"a", "b"};
  const LayoutNode layout =
      parse_layout(R"({"columns": [{"panel": "a"}, {"panel": "b", "front": true}]})", "f", known);
  EXPECT_FALSE(layout.children[0].front);
  EXPECT_TRUE(layout.children[1].front);
  EXPECT_EQ(parse_layout(to_json(layout), "f", known), layout);
  EXPECT_THROW((void)parse_layout(R"({"panel": "a", "front": 1})", "f", known), InputError);
}

TEST(PanelChoices, AMirrorTakesAllThatIsShown) {
  PanelChoices choices;
  choices.note("Errors", "off");
  choices.note_passing("round", "2");
  PanelChoices mirror = choices.mirrored();
  EXPECT_TRUE(mirror.mirrors());
  EXPECT_EQ(mirror.take("Errors", "on"), "off");
  EXPECT_EQ(mirror.take("round", "3"), "2");
  // What passes is no choice of a person's.
  EXPECT_TRUE(choices.changed().empty());
}

TEST(PanelChoices, KeepWhatIsNotAsThePanelHasIt) {
  PanelChoices choices;
  EXPECT_FALSE(choices.take("Errors", "on"));
  choices.note("Errors", "on");
  EXPECT_TRUE(choices.changed().empty());
  choices.note("Errors", "off");
  EXPECT_EQ(choices.changed(), (PanelChoices::Words{{"Errors", "off"}}));
  // What is wanted is handed out once; until then it is kept.
  choices.want({{"Errors", "on"}, {"Other", "2"}});
  EXPECT_EQ(choices.changed().at("Other"), "2");
  EXPECT_EQ(choices.take("Errors", "off"), "on");
  EXPECT_FALSE(choices.take("Errors", "on"));
}

}  // namespace
}  // namespace stillpoint
