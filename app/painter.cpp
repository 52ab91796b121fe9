#include "app/painter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "core/error.hpp"
#include "core/inspect/frame_ranges.hpp"
#include "core/media/image_codec.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/workbench/settings.hpp"

namespace stillpoint {
namespace {

constexpr const char* kWorkbench = "workbench";

std::vector<std::string> names_of(const std::vector<std::unique_ptr<Panel>>& panels) {
  std::vector<std::string> names;
  for (const auto& panel : panels) names.push_back(panel->name());
  return names;
}

bool is_among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

bool PictureChoice::draws(const std::string& name) const {
  return name == kWorkbench ? workbench : is_among(panels, name);
}

PictureChoice choose_pictures(const PainterOptions& options) {
  const std::vector<std::string> known = names_of(make_panels());
  PictureChoice chosen;
  const auto take = [&chosen](const std::string& panel) {
    if (!is_among(chosen.panels, panel)) chosen.panels.push_back(panel);
  };
  for (const std::string& name : split_list(options.panels)) {
    if (name == kWorkbench) {
      chosen.workbench = true;
    } else if (name == "all") {
      for (const std::string& panel : known) take(panel);
    } else if (is_among(known, name)) {
      take(name);
      chosen.named.insert(name);
    } else {
      throw InputError(fmt::format("--panels {}: there is no such panel; there are all, {}, {}", name,
                                   kWorkbench, fmt::join(known, ", ")));
    }
  }
  if (chosen.count() == 0) throw InputError("--panels: names no panel");
  if (!options.layout.empty()) chosen.layout = read_layout(options.layout, known);
  return chosen;
}

Painter::Painter(const PainterOptions& options, PictureChoice chosen)
    : options_(options),
      offscreen_({.width = options.workbench_size.first,
                  .height = options.workbench_size.second,
                  .look = options.look}),
      panels_(make_panels()),
      workbench_(make_panels()),
      chosen_(std::move(chosen)),
      runs_(options.runs) {
  workbench_.set_runs(options.runs);
  if (chosen_.layout) take_choices(*chosen_.layout);
  workbench_.set_layout(chosen_.layout ? *chosen_.layout : default_layout(options.method, options.stereo));
}

Painter::~Painter() { offscreen_.make_current(); }

void Painter::take_choices(const LayoutNode& layout) {
  for (const LayoutNode& child : layout.children) take_choices(child);
  if (layout.is_panel() && !layout.choices.empty()) choices_[&panel(layout.panel)].want(layout.choices);
}

std::vector<std::string> Painter::choices_left() const {
  std::vector<std::string> left;
  for (const std::string& name : chosen_.panels) {
    const auto choices = choices_.find(&panel(name));
    if (choices == choices_.end()) continue;
    for (const auto& [control, value] : choices->second.left())
      left.push_back(fmt::format("{}: {}={}", name, control, value));
  }
  return left;
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

Painter::Picture Painter::paint_picture(const std::string& name, const FrameFunction& draw,
                                        std::pair<int, int> size) {
  Picture picture{name, {}};
  picture.image = paint_frame(
      [&](UiFrame& frame) {
        picture.offers.clear();  // it is drawn more than once, and the last time counts
        if (options_.offers) frame.all_offers = &picture.offers;
        draw(frame);
      },
      size);
  return picture;
}

void Painter::paint(const SessionView& view, const std::function<void(const Picture&)>& done) {
  if (chosen_.workbench)
    done(paint_picture(
        kWorkbench, [&](UiFrame& frame) { workbench_.draw(frame, &view); }, options_.workbench_size));
  for (const std::string& name : chosen_.panels) {
    Panel& chosen = panel(name);
    if (!chosen.is_for(view) && !chosen_.named.contains(name)) continue;
    done(paint_picture(
        name,
        [&](UiFrame& frame) {
          frame.runs = &runs_;
          Workbench::draw_alone(frame, view, chosen, choices_[&chosen]);
        },
        options_.panel_size));
  }
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
