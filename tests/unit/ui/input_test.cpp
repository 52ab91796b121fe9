#include "ui/shell/input.hpp"

#include <gtest/gtest.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

#include "core/error.hpp"
#include "ui/shell/window_input.hpp"
#include "ui/theme/colormap.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

TEST(KeyChordTest, EveryKeyIsReadBackFromItsName) {
  for (int key = 1; key < static_cast<int>(Key::kCount); ++key) {
    const KeyChord chord{static_cast<Key>(key),
                         {.ctrl = key % 2 == 0, .shift = key % 3 == 0, .alt = key % 5 == 0}};
    EXPECT_EQ(parse_key_chord(to_string(chord)), chord) << to_string(chord);
  }
}

TEST(KeyChordTest, ReadsWhatPeopleWrite) {
  EXPECT_EQ(parse_key_chord("ctrl+shift+p"), (KeyChord{Key::kP, {.ctrl = true, .shift = true}}));
  EXPECT_EQ(parse_key_chord("["), (KeyChord{Key::kLeftBracket, {}}));
  EXPECT_EQ(parse_key_chord("Ctrl+"), std::nullopt);
  EXPECT_EQ(parse_key_chord("Hyper+A"), std::nullopt);
  EXPECT_EQ(parse_key_chord(""), std::nullopt);
}

TEST(InputQueueTest, AClickWithinOneFrameReachesTwo) {
  InputQueue queue;
  queue.push(MouseMoved{5.0F, 6.0F});
  queue.push(MouseButton{0, true, {}});
  queue.push(MouseButton{0, false, {}});
  EXPECT_EQ(queue.next_frame().size(), 2U);
  EXPECT_EQ(queue.next_frame().size(), 1U);
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.next_frame().empty());
}

TEST(InputQueueTest, AClickHappensWhereItWasMade) {
  InputQueue queue;
  queue.push(MouseButton{0, true, {}});
  queue.push(MouseMoved{50.0F, 60.0F});
  EXPECT_EQ(queue.next_frame().size(), 1U);
}

TEST(InputQueueTest, MovesAndTextOfAFrameGoTogether) {
  InputQueue queue;
  for (int i = 0; i < 10; ++i) queue.push(MouseMoved{static_cast<float>(i), 0.0F});
  for (const char letter : {'a', 'b', 'c'}) queue.push(TextTyped{static_cast<unsigned>(letter)});
  EXPECT_EQ(queue.next_frame().size(), 13U);
}

TEST(InputQueueTest, KeysUnderDifferentModifiersDoNotMix) {
  InputQueue queue;
  queue.push(KeyChanged{Key::kA, true, {.ctrl = true}});
  queue.push(KeyChanged{Key::kB, true, {}});
  EXPECT_EQ(queue.next_frame().size(), 1U);
}

TEST(WindowInputTest, MapsGlfwsKeys) {
  EXPECT_EQ(key_from_glfw(GLFW_KEY_A), Key::kA);
  EXPECT_EQ(key_from_glfw(GLFW_KEY_Z), Key::kZ);
  EXPECT_EQ(key_from_glfw(GLFW_KEY_9), Key::k9);
  EXPECT_EQ(key_from_glfw(GLFW_KEY_KP_3), Key::k3);
  EXPECT_EQ(key_from_glfw(GLFW_KEY_F12), Key::kF12);
  EXPECT_EQ(key_from_glfw(GLFW_KEY_PAGE_DOWN), Key::kPageDown);
  EXPECT_EQ(key_from_glfw(GLFW_KEY_LEFT_SHIFT), Key::kNone);
  EXPECT_EQ(modifiers_from_glfw(GLFW_MOD_CONTROL | GLFW_MOD_ALT), (Modifiers{.ctrl = true, .alt = true}));
}

TEST(ThemeTest, NamesAreCheckedOnce) {
  EXPECT_EQ(parse_theme("light"), ThemeName::kLight);
  EXPECT_THROW((void)parse_theme("solarized"), InputError);
}

double luminance(Rgb colour) {
  const auto linear = [](std::uint8_t value) {
    const double c = value / 255.0;
    return c <= 0.03928 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(colour.r) + 0.7152 * linear(colour.g) + 0.0722 * linear(colour.b);
}

/// The contrast of WCAG 2: 1 to 21.
double contrast(Rgb a, Rgb b) {
  const double brighter = std::max(luminance(a), luminance(b)), darker = std::min(luminance(a), luminance(b));
  return (brighter + 0.05) / (darker + 0.05);
}

TEST(ThemeTest, TextIsReadableOnEverySurface) {
  for (const ThemeName name : {ThemeName::kDark, ThemeName::kLight}) {
    const Theme& colours = theme(name);
    for (const Rgb surface : {colours.background, colours.panel, colours.raised, colours.plot}) {
      EXPECT_GE(contrast(colours.text, surface), 7.0);
      EXPECT_GE(contrast(colours.text_dim, surface), 4.0);
    }
  }
}

TEST(PaletteTest, RolesStandOutFromTheGround) {
  for (const ThemeName name : {ThemeName::kDark, ThemeName::kLight}) {
    for (int role = 0; role < static_cast<int>(Role::kCount); ++role) {
      EXPECT_GE(contrast(role_colour(static_cast<Role>(role), name), theme(name).plot), 2.0) << role;
    }
  }
}

TEST(ColormapTest, BrightensFromEndToEnd) {
  for (const Colormap map : {Colormap::kViridis, Colormap::kCividis, Colormap::kInferno}) {
    double last = -1.0;
    for (int i = 0; i <= 16; ++i) {
      const double now = luminance(map_colour(map, static_cast<float>(i) / 16.0F));
      EXPECT_GT(now, last);
      last = now;
    }
    EXPECT_EQ(map_colour(map, 7.0F), map_colour(map, 1.0F));
    EXPECT_EQ(map_colour(map, std::nanf("")), map_colour(map, 0.0F));
  }
}

}  // namespace
}  // namespace stillpoint
