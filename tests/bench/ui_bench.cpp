#include <benchmark/benchmark.h>

#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"
#include "tests/ui/gallery.hpp"
#include "ui/scene/scene_renderer.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

/// The trajectory view alone: range(0) points, range(1) poses, range(2) samples a pixel, at 800x600.
void draw_scene(benchmark::State& state) {
  Offscreen offscreen({.width = 64, .height = 64});
  SceneRenderer renderer(offscreen.gl());
  const SceneData scene = example_scene(static_cast<int>(state.range(1)), static_cast<int>(state.range(0)));
  const Framebuffer target(offscreen.gl(), 800, 600, static_cast<int>(state.range(2)));
  SceneView view;
  look_from(view, ViewPreset::kOblique, scene.up);
  fit(view, {800, 600}, bounds(scene));
  for (auto _ : state) {
    orbit(view, {800, 600}, {1.0, 0.0}, scene.up);
    renderer.draw(scene, view, theme(ThemeName::kDark), 1.0F, target);
    offscreen.gl().Finish();
  }
}
BENCHMARK(draw_scene)
    ->Args({100000, 10000, 0})
    ->Args({100000, 10000, 4})
    ->Args({0, 10000, 0})
    ->Args({100000, 10, 0})
    ->Args({0, 10, 0})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void pick_pose(benchmark::State& state) {
  const SceneData scene = example_scene(10000, 0);
  SceneView view;
  look_from(view, ViewPreset::kOblique, scene.up);
  fit(view, {800, 600}, bounds(scene));
  for (auto _ : state)
    benchmark::DoNotOptimize(pick(view, {800, 600}, scene.paths[2].positions, {300, 300}, 9.0));
}
BENCHMARK(pick_pose)->Unit(benchmark::kMillisecond);

/// A whole frame of plots, picture and trajectory view at 1600x900, without reading it back.
void draw_gallery(benchmark::State& state) {
  Offscreen offscreen({.width = 1600, .height = 900});
  Gallery gallery;
  offscreen.render(std::ref(gallery));
  for (auto _ : state) {
    offscreen.draw(std::ref(gallery));
    offscreen.gl().Finish();
  }
}
BENCHMARK(draw_gallery)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// The whole workbench at 1600x900 over a session whose pictures are computed already.
void draw_workbench(benchmark::State& state) {
  OpenOptions short_one;
  short_one.frames = 12;
  Config config;
  config.run.method = "stillpoint";
  Session session(open_sequence("generated:walking_static", short_one), config);
  session.go_to(11);
  const auto view = session.view();
  Offscreen offscreen({.width = 1600, .height = 900});
  Workbench workbench(make_panels());
  const FrameFunction draw = [&](UiFrame& frame) { workbench.draw(frame, view.get()); };
  offscreen.render(draw);
  for (auto _ : state) {
    offscreen.draw(draw);
    offscreen.gl().Finish();
  }
  offscreen.make_current();
}
BENCHMARK(draw_workbench)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Frame after frame of a session, as while it plays: range(0) of default_layout()'s tiles alone at the size
/// they have in a window of 1600x900, or, below 0, the whole workbench.
void draw_playing(benchmark::State& state) {
  OpenOptions short_one;
  short_one.frames = 12;
  Config config;
  config.run.method = "stillpoint";
  Session session(open_sequence("generated:walking_static", short_one), config);
  std::vector<std::shared_ptr<const SessionView>> views;
  for (int frame = 6; frame < 12; ++frame) {
    session.go_to(frame);
    views.push_back(session.view());
  }
  const std::vector<std::string> tiles = panels_of(default_layout(config.run.method));
  const bool whole = state.range(0) < 0;
  if (!whole && static_cast<std::size_t>(state.range(0)) >= tiles.size())
    return state.SkipWithError("no such tile");
  Offscreen offscreen({.width = whole ? 1600 : 400, .height = whole ? 900 : 350});
  Workbench workbench(make_panels());
  if (!whole) {
    LayoutNode alone;
    alone.panel = tiles[static_cast<std::size_t>(state.range(0))];
    workbench.set_layout(alone);
    state.SetLabel(alone.panel);
  }
  std::size_t at = 0;
  const FrameFunction draw = [&](UiFrame& frame) { workbench.draw(frame, views[at % views.size()].get()); };
  offscreen.render(draw);
  for (auto _ : state) {
    ++at;
    offscreen.draw(draw);
  }
  offscreen.make_current();
}
BENCHMARK(draw_playing)
    ->DenseRange(-1, 7)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// From nothing to the first image: context, fonts, shaders, one frame.
void open_offscreen(benchmark::State& state) {
  for (auto _ : state) {
    Offscreen offscreen({.width = 1600, .height = 900});
    benchmark::DoNotOptimize(offscreen.render([](UiFrame&) { ImGui::Text("hello"); }));
  }
}
BENCHMARK(open_offscreen)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void upload_image(benchmark::State& state) {
  Offscreen offscreen({.width = 64, .height = 64});
  Texture texture(offscreen.gl(), state.range(0) != 0 ? Sampling::kPixels : Sampling::kNearest);
  const cv::Mat image = example_image(640, 480);
  for (auto _ : state) {
    texture.upload(image);
    offscreen.gl().Finish();
  }
}
BENCHMARK(upload_image)
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace stillpoint::testing

BENCHMARK_MAIN();
