#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

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

/// ms of processor time so far, of this thread or of all.
double used_ms(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// The window's frames while a session plays whose pictures are computed already: every other one has another
/// frame of the sequence, to which tiles take in turn. range(0) is the layout. Counters are processor time a
/// frame of the interface: its mean, what 95 % stay within, the worst; and of the mean, what building it
/// takes, what the drawing thread does for OpenGL, and what OpenGL's own threads do.
void play_in_turn(benchmark::State& state) {
  constexpr int kFirst = 20, kFrames = 24;
  OpenOptions short_one;
  short_one.frames = kFirst + kFrames;
  Config config;
  config.run.method = "stillpoint";
  const char* where = std::getenv("STILLPOINT_BENCH_SEQUENCE");
  Session session(open_sequence(where == nullptr ? "generated:walking_xyz" : where, short_one), config);
  std::vector<std::shared_ptr<const SessionView>> views;
  for (int frame = kFirst; frame < kFirst + kFrames; ++frame) {
    session.go_to(frame);
    auto playing = std::make_shared<SessionView>(*session.view());
    playing->playing = true;
    views.push_back(std::move(playing));
  }
  const std::vector<NamedLayout> layouts = named_layouts();
  const NamedLayout& chosen = layouts.at(static_cast<std::size_t>(state.range(0)));
  state.SetLabel(std::string(chosen.title));
  Offscreen offscreen({.width = 1600, .height = 900});
  Workbench workbench(make_panels());
  workbench.set_layout(chosen.make(config.run.method));
  std::size_t drawn = 0;
  double built_ms = 0.0;
  const FrameFunction draw = [&](UiFrame& frame) {
    const double begin = used_ms(CLOCK_THREAD_CPUTIME_ID);
    workbench.draw_in_turn(frame, views[drawn / 2 % views.size()]);
    built_ms += used_ms(CLOCK_THREAD_CPUTIME_ID) - begin;
  };
  for (; drawn < 2 * views.size(); ++drawn) offscreen.draw(draw);  // all is there once
  std::vector<double> frames_ms;
  double mine_ms = 0.0, sum_ms = 0.0;
  built_ms = 0.0;
  for (auto _ : state) {
    const double all = used_ms(CLOCK_PROCESS_CPUTIME_ID), mine = used_ms(CLOCK_THREAD_CPUTIME_ID);
    offscreen.draw(draw);
    ++drawn;
    mine_ms += used_ms(CLOCK_THREAD_CPUTIME_ID) - mine;
    frames_ms.push_back(used_ms(CLOCK_PROCESS_CPUTIME_ID) - all);
    sum_ms += frames_ms.back();
  }
  std::sort(frames_ms.begin(), frames_ms.end());
  const auto count = static_cast<double>(frames_ms.size());
  state.counters["mean"] = sum_ms / count;
  state.counters["95%"] = frames_ms[frames_ms.size() * 95 / 100];
  state.counters["worst"] = frames_ms.back();
  state.counters["build"] = built_ms / count;
  state.counters["gl"] = (mine_ms - built_ms) / count;
  state.counters["raster"] = (sum_ms - mine_ms) / count;
  offscreen.make_current();
}
BENCHMARK(play_in_turn)
    ->DenseRange(0, 4)
    ->Iterations(192)
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
