#include "app/painter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "core/error.hpp"
#include "core/inspect/frame_ranges.hpp"
#include "core/media/image_codec.hpp"
#include "ui/workbench/settings.hpp"

namespace stillpoint {
namespace {

constexpr const char* kWorkbench = "workbench";

}  // namespace

Painter::Painter(const PainterOptions& options)
    : options_(options),
      offscreen_({.width = options.workbench_size.first,
                  .height = options.workbench_size.second,
                  .look = options.look}),
      panels_(make_panels()),
      workbench_(make_panels()),
      runs_(options.runs) {
  workbench_.set_runs(options.runs);
  choose(options.panels);
  if (options.layout.empty()) {
    workbench_.set_layout(default_layout(options.method, options.stereo));
    return;
  }
  const LayoutNode layout = read_layout(options.layout, workbench_.panel_names());
  take_choices(layout);
  workbench_.set_layout(layout);
}

Painter::~Painter() { offscreen_.make_current(); }

void Painter::choose(const std::string& names) {
  std::vector<std::string> known;
  for (const auto& panel : panels_) known.push_back(panel->name());
  for (const std::string& name : split_list(names)) {
    if (name == kWorkbench) {
      workbench_chosen_ = true;
      continue;
    }
    bool found = false;
    for (const auto& panel : panels_) {
      if (name != "all" && name != panel->name()) continue;
      found = true;
      if (name != "all") named_.insert(panel.get());
      if (std::find(panels_chosen_.begin(), panels_chosen_.end(), panel.get()) == panels_chosen_.end())
        panels_chosen_.push_back(panel.get());
    }
    if (!found)
      throw InputError(fmt::format("--panels {}: there is no such panel; there are all, {}, {}", name,
                                   kWorkbench, fmt::join(known, ", ")));
  }
  if (picture_count() == 0) throw InputError("--panels: names no panel");
}

void Painter::take_choices(const LayoutNode& layout) {
  for (const LayoutNode& child : layout.children) take_choices(child);
  if (layout.is_panel() && !layout.choices.empty()) choices_[&panel(layout.panel)].want(layout.choices);
}

std::vector<std::string> Painter::choices_left() const {
  std::vector<std::string> left;
  for (const Panel* chosen : panels_chosen_) {
    const auto choices = choices_.find(chosen);
    if (choices == choices_.end()) continue;
    for (const auto& [control, value] : choices->second.left())
      left.push_back(fmt::format("{}: {}={}", chosen->name(), control, value));
  }
  return left;
}

bool Painter::draws(const std::string& name) const {
  if (name == kWorkbench) return workbench_chosen_;
  return std::any_of(panels_chosen_.begin(), panels_chosen_.end(),
                     [&](const Panel* panel) { return panel->name() == name; });
}

Panel& Painter::panel(const std::string& name) const {
  for (const auto& panel : panels_)
    if (panel->name() == name) return *panel;
  throw std::logic_error("there is no panel " + name);
}

cv::Mat Painter::paint_frame(const FrameFunction& draw, std::pair<int, int> size) {
  offscreen_.resize(size.first, size.second);
  return offscreen_.render(draw);
}

cv::Mat Painter::paint_panel(const SessionView& view, const std::string& name, std::pair<int, int> size) {
  return paint_frame(
      [&](UiFrame& frame) {
        frame.controls = false;
        Workbench::draw_alone(frame, view, panel(name));
      },
      size);
}

std::vector<Painter::Picture> Painter::paint(const SessionView& view) {
  std::vector<Picture> pictures;
  if (workbench_chosen_)
    pictures.push_back({kWorkbench, paint_frame([&](UiFrame& frame) { workbench_.draw(frame, &view); },
                                                options_.workbench_size)});
  for (Panel* chosen : panels_chosen_) {
    if (!chosen->is_for(view) && !named_.contains(chosen)) continue;
    pictures.push_back({chosen->name(), paint_frame(
                                            [&](UiFrame& frame) {
                                              frame.runs = &runs_;
                                              Workbench::draw_alone(frame, view, *chosen, choices_[chosen]);
                                            },
                                            options_.panel_size)});
  }
  return pictures;
}

void ImageWriter::write(const std::filesystem::path& path, const cv::Mat& image) {
  while (writing_.size() >= std::max(2U, std::thread::hardware_concurrency())) {
    std::future<void> first = std::move(writing_.front());
    writing_.pop_front();
    first.get();
  }
  writing_.push_back(std::async(std::launch::async, [path, image] { write_image(path, image); }));
}

void ImageWriter::finish() {
  while (!writing_.empty()) {
    std::future<void> first = std::move(writing_.front());
    writing_.pop_front();
    first.get();
  }
}

void write_image(const std::filesystem::path& path, const cv::Mat& image) {
  // Fast rather than small: packing well would take longer than drawing.
  bool written = false;
  try {
    written = save_image(path, image, 1);
  } catch (const cv::Exception&) {
  }
  std::error_code error;
  if (!written || std::filesystem::file_size(path, error) == 0 || error)
    throw InputError(
        fmt::format("{}: cannot be written (no permission, or the disk is full)", path.string()));
}

}  // namespace stillpoint
