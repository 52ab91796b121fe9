// The panels of debugging: what they show of a session put together by hand, and what they ask of it.
#include <chrono>

#include "tests/support/golden.hpp"
#include "tests/ui/panel_stage.hpp"
#include "tests/ui/session_example.hpp"

namespace stillpoint::testing {
namespace {

TEST(DebugPanels, GoldenImages) {
  const SessionView example = debug_example();
  for (const auto& [name, theme] : {std::pair{"timeline", ThemeName::kDark},
                                    {"breakpoints", ThemeName::kLight},
                                    {"bookmarks", ThemeName::kDark},
                                    {"compare", ThemeName::kLight},
                                    {"removal", ThemeName::kDark},
                                    {"errors", ThemeName::kLight}}) {
    PanelStage stage(name, {theme, 1.0F}, 640, 420);
    EXPECT_TRUE(matches_golden(stage.render(example), std::string("debug_") + name));
  }
}

}  // namespace
}  // namespace stillpoint::testing
